"""Small URDFs for tests."""

INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'


def body(mass=1, xyz="0 0 0", rpy="0 0 0", inertia=INERTIA):
    origin = f'<origin xyz="{xyz}" rpy="{rpy}"/>'
    return f'<inertial>{origin}<mass value="{mass}"/>{inertia}</inertial>'


def link(name, inside=""):
    return f'<link name="{name}">{inside}</link>'


def joint(name, parent, child, inside="", kind="revolute"):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


def origin(xyz="0 0 0", rpy="0 0 0"):
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>'


def axis(xyz):
    return f'<axis xyz="{xyz}"/>'


def robot(*elements, name="robot"):
    """A file of one element a line; the first is in line 2."""
    return "\n".join([f'<robot name="{name}">', *elements, "</robot>"])


def written(folder, text, name="robot.urdf"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path
