"""robot.yaml: read without evaluating anything, errors with file, line and field; and written.

document      text, or a dictionary, as a tree that remembers its lines
expressions   text as an exact value
values        what a value may be, by kinds
schema        what the mappings may say
fields        which of that goes together
problems      what is wrong, in words
coordinates   by which joint variables joints move
references    what links are called, and what they are on
drives        gears, friction, springs, at the joint
meanings      where parameters are in a file
remarks       what is legal and probably not meant
links         from a file to links
build         from a file to rows, or links
reader        from a path to what a file says
text          values and mappings as text
placements    elementary motions as rows, placements and axes
write         links as a file
"""
