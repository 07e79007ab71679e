"""Hard devices, hands, encoders and amplifiers."""

from plant_case import ACTIVE, CYCLE, LIMIT, MARGIN, SATURATED, STEP, Case, fix, up

NOBODY = ("hand.model=custom", "hand.stiffness=0 N/m", "hand.damping=0 N s/m")
ARM = ("device.kinematics.kind=serial-arm",)
JOINTS = (*ARM, "device.encoder.at=joints")
UNDAMPED = ("device.dynamics.damping=0 N s/m",)
WEIGHT = ("device.gravity.compensated=0",)
MOTOR = ("device.motor.lever=200 mm",)


def thumb_and_finger(gap_mm: float) -> str:
    """Two devices that close on nothing, to this gap."""
    probes = [
        f'{{start=["0 mm","{20 * side} mm","5 mm"],motion=[{{phase="press",'
        f'to=["0 mm","{gap_mm / 2 * side:g} mm","5 mm"],duration="0.5 s"}}]}}'
        for side in (-1, 1)
    ]
    return f"probe=[{','.join(probes)}]"


DRIVE = (
    Case(
        "current saturation",
        "the hand presses deeper than the force that the amplifier can give",
        (*MOTOR, "device.amplifier.current_limit=0.1 A"),
        up(SATURATED),
        (
            fix("wall.stiffness=20 N/m"),
            fix('probe.motion[0].to=["0 mm", "0 mm", "-0.3 mm"]'),
            fix("device.amplifier.current_limit=2.4 A"),
        ),
    ),
    Case(
        "beyond what the maker allows",
        "a clamp at the tip, its direction kept",
        ("device.limits.force=0.5 N",),
        up(SATURATED),
        (fix("wall.stiffness=100 N/m"), fix('probe.motion[0].to=["0 mm", "0 mm", "-1 mm"]')),
    ),
    Case(
        "an amplifier of 10 Hz",
        "its lag counts as 16 ms of latency: 877 N/m stably",
        (*MOTOR, "device.amplifier.bandwidth=10 Hz", "wall.stiffness=2000 N/m"),
        up(CYCLE, ACTIVE, SATURATED, MARGIN),
        (
            fix("device.amplifier.bandwidth=500 Hz"),
            fix("wall.stiffness=200 N/m"),
            fix("device.dynamics.damping=10 N s/m"),
        ),
    ),
    Case(
        "a converter of four bits",
        "steps of 0.8 N: the force is never the one that holds the device",
        (*MOTOR, "device.dac.bits=4", "device.amplifier.gain=0.5 A/V"),
        up(CYCLE, ACTIVE),
        (fix("device.dac.bits=12"), fix("device.friction.force=1 N")),
    ),
)

ENCODER = (
    Case(
        "a limit cycle of one count",
        "friction of 0.05 N below K·Δ/2 = 0.5 N: no rest between two counts (Abbott & Okamura)",
        (
            "device.encoder.resolution=1 mm",
            "device.friction.force=0.05 N",
            "wall.stiffness=1000 N/m",
        ),
        up(CYCLE, ACTIVE),
        (
            fix("device.encoder.resolution=0.05 mm"),
            fix("device.friction.force=0.6 N"),
            fix("wall.stiffness=90 N/m"),
            fix("device.dynamics.damping=5 N s/m", left=up(CYCLE)),
        ),
    ),
    Case(
        "the same with steps of 10 mm",
        "the wall is a kick of 50 N in every count",
        ("device.encoder.resolution=10 mm", "wall.stiffness=5000 N/m"),
        up(CYCLE, ACTIVE),
        (
            fix("device.encoder.resolution=10 um", "wall.stiffness=1000 N/m", left=up(CYCLE)),
            fix(
                "device.encoder.resolution=10 um",
                "wall.stiffness=1000 N/m",
                "device.friction.force=0.05 N",
            ),
        ),
    ),
    Case(
        "steps of 1 um",
        "as good as none",
        ("device.encoder.resolution=1 um",),
    ),
    Case(
        "encoders at the joints",
        "steps of 60 um at the tip and no friction: a tremble of less than a micrometre",
        JOINTS,
        up(CYCLE),
        (
            fix("device.encoder.counts_per_turn=1000000"),
            fix("device.friction.force=0.05 N"),
        ),
    ),
    Case(
        "a counter of 8 bits",
        "wraps before the device moves: the host sees another place",
        (*JOINTS, "device.encoder.counter_bits=8", "device.friction.force=0.05 N"),
        up(LIMIT),
        (fix("device.encoder.counter_bits=24"),),
    ),
    Case(
        "a counter of 9 bits",
        "wraps on the way: the tip jumps, and so does the force",
        (*JOINTS, "device.encoder.counter_bits=9", "device.friction.force=0.05 N"),
        up(ACTIVE, LIMIT, STEP),
        (fix("device.encoder.counter_bits=24"),),
    ),
)

HAND = (
    Case(
        "lets go under load",
        "the spring of the wall throws the device out; its damping brings it to rest",
        ("hand.lets_go=1 s",),
    ),
    Case(
        "lets go under load, undamped",
        "the wall gives back more than it took, since its force is held",
        (*UNDAMPED, "hand.lets_go=1 s"),
        up(ACTIVE, MARGIN),
        (fix("device.dynamics.damping=1 N s/m"),),
    ),
    Case(
        "thrown at the wall, without damping and friction",
        "comes back faster than it went, and flies on for ever",
        (*UNDAMPED, "hand.lets_go=0.25 s"),
        up(ACTIVE, MARGIN),
        (
            fix("device.dynamics.damping=1 N s/m"),
            fix("device.friction.force=0.05 N", left=up(MARGIN)),
        ),
    ),
    Case(
        "dropped on the wall",
        "weight without a hand: bounces, and higher every time without damping",
        (*NOBODY, *WEIGHT, *UNDAMPED),
        up(CYCLE, ACTIVE, MARGIN),
        (fix("device.dynamics.damping=1 N s/m"), fix("wall.damping=5 N s/m")),
    ),
    Case(
        "weight without hand and wall",
        "falls out of the range of the position's register",
        (*NOBODY, *WEIGHT, "wall.normal=[0, 0, -1]", 'wall.point=["0 m", "0 m", "2 m"]'),
        up(LIMIT),
    ),
    Case(
        "the stiffest hand that is allowed",
        "1e6 N/m and 1e4 N s/m: moves the device as if by a path",
        ("hand.model=custom", "hand.stiffness=1e6 N/m", "hand.damping=1e4 N s/m"),
    ),
    Case(
        "a hand of 1000 kg that hardly damps",
        "the hand swings by itself at 5 Hz",
        (
            "hand.model=custom",
            "hand.mass=1000 kg",
            "hand.stiffness=1e6 N/m",
            "hand.grip_stiffness=1e6 N/m",
        ),
        up(CYCLE),
        (fix("hand.damping=1e4 N s/m"),),
    ),
    Case(
        "two fingers that close on nothing",
        "free motion: no force, and rest",
        (thumb_and_finger(2),),
    ),
)

DEVICE = (
    Case(
        "the lightest device",
        "0.1 g: the hand's damping holds it",
        ("device.dynamics.mass=0.1 g",),
    ),
    Case(
        "the lightest device in the stiffest hand",
        "faster than can be followed",
        (
            "device.dynamics.mass=0.1 g",
            "hand.model=custom",
            "hand.stiffness=1e6 N/m",
            "hand.damping=1e4 N s/m",
        ),
        refused=True,
    ),
    Case(
        "a heavy device without damping, in nobody's hand",
        "10 kg at a wall of both sides: swings at 1.6 Hz and grows",
        (
            "device.dynamics.mass=10 kg",
            "wall.sides=both",
            'wall.point=["0 mm", "0 mm", "5 mm"]',
            "device.gravity.compensated=0.99",
            *UNDAMPED,
            *NOBODY,
        ),
        up(ACTIVE, MARGIN),
        (fix("device.dynamics.damping=100 N s/m"),),
    ),
    Case(
        "a motion out of reach",
        "the arm is 385 mm long",
        (*ARM, 'probe.motion[0].to=["0 mm", "0 mm", "-380 mm"]'),
        refused=True,
    ),
    Case(
        "pulled out of reach",
        "a hand lets go, and a wall that pulls takes the device through a singular pose",
        (
            *JOINTS,
            *MOTOR,
            "wall.sides=both",
            "wall.stiffness=30 N/m",
            'wall.point=["0 mm", "0 mm", "-500 mm"]',
            "hand.lets_go=0.3 s",
        ),
        up(LIMIT),
        (fix("wall.sides=one"),),
    ),
)
