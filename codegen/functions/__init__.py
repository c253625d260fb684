"""What can be generated.

arguments       what functions take and give: names, shapes, units, frames
catalogue       the functions of the dynamics
at_frame        those of a frame, at any
own             functions of one's own, in SymPy
regressors      what torques and momenta are per unit of inertial parameters
together        several functions in one call
singular        arms without forward dynamics
requested       what was asked for, brought to one form
"""
