"""The scalars of the symbolic route: rings that the formulas of the texts run over.

ring           what a ring offers
trig           exact trigonometric polynomials
dual           numbers that carry their derivatives
random_point   numbers mod a prime, at a random point
"""
