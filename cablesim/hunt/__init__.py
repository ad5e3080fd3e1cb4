"""The hunt for answers that are wrong in silence: random and adversarial scenarios, solved and judged."""
