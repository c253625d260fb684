"""MJCF, the format of MuJoCo, through MuJoCo's own reader and compiler.

sources        a file and what it includes, before MuJoCo opens them
specification  MuJoCo's specification of a model; what has no part in its dynamics taken out; errors
values         floating-point numbers and quaternions back as decimals and turns
couplings      joints that equality constraints tie to others
obstacles      what is said of a model that joints and bodies do not hold
build          links that can be put together
reader         from a path to these
"""
