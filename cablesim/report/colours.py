"""Colours and dashes of all figures, in print and on the page. Nothing heavy is imported."""

from cablesim.status import Status

# Okabe and Ito's palette: distinct for every kind of colour vision.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
# Dashes as matplotlib calls them, and the same in pixels.
DASHES = ("-", "--", "-.", ":")
PIXEL_DASHES = ([1, 0], [6, 3], [6, 2, 1, 2], [2, 2])
# Of Okabe and Ito's palette, but for what is solved, not installed or not run: told apart by any kind of colour vision,
# and by lightness alone.
STATUS_COLOURS = {
    Status.ok: "#D0D0D0",
    Status.infeasible: "#56B4E9",
    Status.not_converged: "#D55E00",
    Status.out_of_domain: "#000000",
    Status.unavailable: "#5B2A86",
    Status.not_run: "#FFFFFF",
}
