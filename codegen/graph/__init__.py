"""The expression graph.

nodes        expressions, each of which is one node
from_sympy   expressions of SymPy as nodes
derivatives  derivatives of nodes
"""
