"""Scenarios that run side by side in vector instructions.

Arrays of such scenarios are flat, with the lane as the last and fastest index, and LANES long in it; each loop
`for w in range(width)` over the lanes that are in use becomes vector code (sixteen is the least number for which the
compiler makes it). It does so only if the loop calls no library, and if arrays are slices with constant places: an
index that might be negative costs the vectors. A number has the same bits in any lane, and whatever the width is.
"""

LANES = 16
