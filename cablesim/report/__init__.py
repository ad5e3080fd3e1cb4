"""What people look at: tables, audits, figures, descriptions and estimates."""
