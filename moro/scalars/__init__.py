"""The scalars of the symbolic route: rings that the formulas of the texts run over.

ring           what a ring offers
free           sums of monomials as SymPy's polynomials
relations      rules by which monomials are rewritten to one form
trig           exact trigonometric polynomials
dual           numbers that carry their derivatives
random_point   numbers mod a prime, at a random point
relative       trigonometric polynomials in angles between joints
points         polynomials at a point
quotient       quotients in lowest terms
"""
