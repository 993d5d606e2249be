"""The Puma 560 as published: tables of lengths, masses, friction and limits, from which all models are built.

Frames: frame 0 is `world`, on the floor under the pedestal; frame i (1 to 6) is the standard Denavit-Hartenberg frame
behind joint i, fixed to link i. The tool's grasp point lies on z of frame 6.

The sources disagree, so there are variants: `VARIANTS` has them by name, each with the source of every column. A column
that a source does not give is taken from the default, and its entry says so. All variants have the frames, the zero
position and therefore the limits of Paul; tables in the frames of Armstrong, Khatib and Burdick or of Lee, whose joints
2 and 3 are half a turn off, were converted. The variants differ in lengths (`d` of joint 3: 125.4 to 150.1 mm) and in
inertia (of the motor at joint 2: 2.3 or 4.8 kg m^2), so a plan is of one `Arm` (`model`) and no other.

The moments of inertia about the middle axis of link 3: 0.086 kg m^2 in the table of the toolbox that came with Corke
and Armstrong-Helouvry, 0.066 in the same toolbox's table after Armstrong, Khatib and Burdick. With 0.066 and 0.0125
about the other axes the first is 0.0075 more than any rigid body can have (no moment exceeds the sum of the other two;
each was measured by itself, hung from wires); the second is possible. Of link 1 only the moment about its own axis is
known. `mjcf.physical_inertia` has what the simulated arm does about both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi, radians
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Link:
    """One row of a table: joint i and the link behind it, in frame i."""

    d: float  # m, offset along the joint's axis
    a: float  # m, length along x of the link's frame
    alpha: float  # rad, twist about x of the link's frame
    mass: float  # kg
    com: tuple[float, float, float]  # m, centre of mass in the link's frame
    inertia: tuple[float, float, float]  # kg m^2, xx yy zz about the centre of mass
    motor_inertia: float  # kg m^2, at the motor
    gear: float  # motor turns per joint turn, with its sign
    viscous: float  # N m s, at the motor
    coulomb: tuple[float, float]  # N m, at the motor, for turning forward and backward
    lower: float  # rad, with the zero position of this table
    upper: float  # rad
    torque: float  # N m, at the joint
    speed: float  # rad/s, at the joint
    acceleration: float  # rad/s^2, at the joint


CORKE_ARMSTRONG: Final = (
    "P. Corke, B. Armstrong-Helouvry: A search for consensus among model parameters reported for the PUMA 560 robot, "
    "Proc. IEEE ICRA 1994, pp. 1608-1613"
)
ARMSTRONG: Final = (
    "B. Armstrong, O. Khatib, J. Burdick: The explicit dynamic model and inertial parameters of the PUMA 560 arm, "
    "Proc. IEEE ICRA 1986, pp. 510-518"
)
CORKE: Final = "P. Corke: Visual Control of Robots, Research Studies Press 1996"
WANG_CHEN: Final = (
    "L. Wang, C. Chen: A combined optimization method for solving the inverse kinematics problem of mechanical "
    "manipulators, IEEE Trans. Robotics and Automation 7(4), 1991, pp. 489-499"
)

FU_GONZALEZ_LEE: Final = (
    "K. Fu, R. Gonzalez, C. Lee: Robotics: Control, Sensing, Vision, and Intelligence, McGraw-Hill 1987, fig. 2.11"
)
TOOLBOX_AKB: Final = (
    f"{ARMSTRONG}; as in P. Corke's Robotics Toolbox for MATLAB, mdl_puma560akb, converted from its modified frames"
)

DEFAULT_VARIANT: Final = "corke-armstrong"
_SOURCES: Final[dict[str, str]] = {
    "d": f"{CORKE_ARMSTRONG}; d of joint 1 (26.45 in, floor to shoulder) and of joint 6 (flange): {CORKE}, ch. 2",
    "a": CORKE_ARMSTRONG,
    "alpha": f"R. Paul's twists as in {CORKE_ARMSTRONG}: with all joints at zero the arm is right-handed",
    "mass": f"{ARMSTRONG}, as converted in {CORKE_ARMSTRONG}; link 1 was never measured, it does not matter",
    "com": f"{ARMSTRONG}, as converted in {CORKE_ARMSTRONG}",
    "inertia": f"{ARMSTRONG}, as converted in {CORKE_ARMSTRONG}; of link 1 only yy, about its axis, is known",
    "motor_inertia": CORKE_ARMSTRONG,
    "gear": CORKE_ARMSTRONG,
    "viscous": CORKE_ARMSTRONG,
    "coulomb": CORKE_ARMSTRONG,
    "lower": f"{WANG_CHEN}, with the zero position of Paul's frames",
    "upper": f"{WANG_CHEN}, with the zero position of Paul's frames",
    "torque": f"{ARMSTRONG}, table 7",
    "speed": f"{CORKE}, tables 2.18 and 2.21: voltage saturation over the gear ratio",
    "acceleration": "derived here: inverse dynamics of this table stays within `torque` with all joints at full speed",
}

_LINKS: Final = (
    Link(0.67183, 0.0, pi / 2, 0.0, (0.0, 0.0, 0.0), (0.0, 0.35, 0.0), 200e-6, -62.6111, 1.48e-3, (0.395, 0.435),
         radians(-160), radians(160), 97.6, 1.92, 10.0),
    Link(0.0, 0.4318, 0.0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539), 200e-6, 107.815, 0.817e-3,
         (0.126, 0.071), radians(-45), radians(225), 186.4, 1.51, 8.0),
    Link(0.15005, 0.0203, -pi / 2, 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.086, 0.0125), 200e-6, -53.7063, 1.38e-3,
         (0.132, 0.105), radians(-225), radians(45), 89.4, 2.40, 16.0),
    Link(0.4318, 0.0, pi / 2, 0.82, (0.0, 0.019, 0.0), (1.8e-3, 1.3e-3, 1.8e-3), 33e-6, 76.0364, 71.2e-6,
         (11.2e-3, 16.9e-3), radians(-110), radians(170), 24.2, 5.34, 40.0),
    Link(0.0, 0.0, -pi / 2, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.4e-3, 0.3e-3), 33e-6, 71.923, 82.6e-6,
         (9.26e-3, 14.5e-3), radians(-100), radians(100), 20.1, 5.09, 40.0),
    Link(0.05625, 0.0, 0.0, 0.09, (0.0, 0.0, 0.032 - 0.05625), (0.15e-3, 0.15e-3, 0.04e-3), 33e-6, 76.686, 36.7e-6,
         (3.96e-3, 10.5e-3), radians(-266), radians(266), 21.3, 5.74, 40.0),
)  # fmt: skip


@dataclass(frozen=True)
class Variant:
    """One published arm: its six rows, and for each column where it is from."""

    name: str
    links: tuple[Link, ...]
    sources: Mapping[str, str]


def _variant(name: str, columns: Mapping[str, tuple[str, tuple[Any, ...]]]) -> Variant:
    """Return the variant with these columns, each a source and six values; the others are those of the default."""
    links = tuple(replace(link, **{c: v[i] for c, (_, v) in columns.items()}) for i, link in enumerate(_LINKS))
    borrowed = {
        column: f"not given there, so that of {DEFAULT_VARIANT}: {source}" for column, source in _SOURCES.items()
    }
    return Variant(name, links, borrowed | {column: source for column, (source, _) in columns.items()})


_RANGES = f"{FU_GONZALEZ_LEE}: the same ranges, with his zero half a turn off in joints 2 and 3"
VARIANTS: Final[Mapping[str, Variant]] = {
    variant.name: variant
    for variant in (
        Variant(DEFAULT_VARIANT, _LINKS, _SOURCES),
        _variant("armstrong-khatib-burdick", {
            "d": (TOOLBOX_AKB, (0.67183, 0.0, 0.2435 - 0.0934, 0.4331, 0.0, 0.05625)),
            "a": (TOOLBOX_AKB, (0.0, 0.4318, 0.0203, 0.0, 0.0, 0.0)),
            "mass": (TOOLBOX_AKB, (0.0, 17.4, 4.8, 0.82, 0.34, 0.09)),
            "com": (TOOLBOX_AKB, ((0.0, 0.0, 0.0), (0.068 - 0.4318, 0.006, 0.2435 - 0.016), (-0.0203, -0.014, 0.070),
                                  (0.0, 0.019, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.032 - 0.05625))),
            "inertia": (TOOLBOX_AKB, ((0.0, 0.35, 0.0), (0.13, 0.524, 0.539), (0.066, 0.066, 0.0125),
                                      (1.8e-3, 1.3e-3, 1.8e-3), (0.3e-3, 0.4e-3, 0.3e-3), (0.15e-3, 0.15e-3, 0.04e-3))),
            "motor_inertia": (TOOLBOX_AKB, (291e-6, 409e-6, 299e-6, 35e-6, 35e-6, 35e-6)),
            "viscous": ("not given there: none", (0.0,) * 6),
            "coulomb": ("not given there: none", ((0.0, 0.0),) * 6),
        }),
        _variant("fu-gonzalez-lee", {
            "d": (FU_GONZALEZ_LEE, (0.67183, 0.0, 0.14909, 0.43307, 0.0, 0.05625)),
            "a": (FU_GONZALEZ_LEE, (0.0, 0.4318, 0.02032, 0.0, 0.0, 0.0)),
            "lower": (_RANGES, tuple(link.lower for link in _LINKS)),
            "upper": (_RANGES, tuple(link.upper for link in _LINKS)),
        }),
        _variant("corke-1996", {
            "d": (f"{CORKE}, table 2.1", (0.67183, 0.0, 0.1254, 0.4318, 0.0, 0.05625)),
            "a": (f"{CORKE}, table 2.1", (0.0, 0.4318, 0.0203, 0.0, 0.0, 0.0)),
        }),
    )
}  # fmt: skip

# The gripper is our own design: two fingers that close along y of frame 6.
TOOL_LENGTH: Final = 0.13  # m, flange to grasp point
GRIPPER_MASS: Final = 0.25  # kg
GRIPPER_COM: Final = (0.0, 0.0, 0.05)  # m, in frame 6
GRIPPER_INERTIA: Final = (6e-4, 5e-4, 3e-4)  # kg m^2
GRASP_DEPTH: Final = 0.01  # m, by which the fingers overlap an object that they hold
FINGER_TRAVEL: Final = 0.015  # m, of each finger between closed and open
