"""Results as people write them.

display           polynomials in their shortest common form
products          products of sums that sums are
squares           squares of sums among the terms of a sum
named_constants   constants that long results have in common
collect           M, C, G and equations in named constants
collected         a result in named constants
notation          expressions in the notation of the texts
typeset           formulas as boxes, to LaTeX and MathML
equations         equations that fit on a page
matrix_form       M qdd + C qd + G = tau
tables, notebook, markup, plain    where they are shown
"""
