"""Hard walls, and forces that are late."""

from plant_case import ACTIVE, CLAMPED, CYCLE, MARGIN, Case, fix, up

STIFFNESS = (
    Case("a soft wall", "below b/(T/2 + L) = 1000 N/m the loop is passive, whoever holds it"),
    Case(
        "just inside the edge",
        "stable up to 5610 N/m by the eigenvalues: comes to rest, but the impact's swing feeds on "
        "the held force until it has",
        ("wall.stiffness=5500 N/m",),
        up(ACTIVE),
        (
            fix("wall.stiffness=4000 N/m"),
            fix("wall.damping=5 N s/m"),
            fix("device.dynamics.damping=2 N s/m"),
        ),
    ),
    Case(
        "just beyond the edge",
        "2 % beyond it, and swings on at the eigenvalues' frequency",
        ("wall.stiffness=5722 N/m",),
        up(CYCLE, ACTIVE, MARGIN),
        (
            fix("wall.stiffness=4000 N/m"),
            fix("wall.damping=5 N s/m"),
            fix("device.dynamics.damping=2 N s/m"),
            fix("budget.period=1 ms", "frames=3000"),
        ),
    ),
    Case(
        "a very stiff wall",
        "twenty times beyond the edge: thrown out, comes back, and so on",
        ("wall.stiffness=1e5 N/m",),
        up(CYCLE, ACTIVE, MARGIN),
        (
            fix("wall.stiffness=4000 N/m"),
            fix("device.dynamics.damping=150 N s/m"),
            fix("budget.period=100 us", "frames=30000", left=up(ACTIVE)),
        ),
    ),
    Case(
        "the same, that pulls too",
        "grows until the register of the force clamps it",
        ("wall.stiffness=1e5 N/m", "wall.sides=both", 'wall.point=["0 mm", "0 mm", "5 mm"]'),
        up(CYCLE, ACTIVE, CLAMPED, MARGIN),
        (fix("wall.stiffness=900 N/m"),),
    ),
    Case(
        "a wall with much damping",
        "a damper that is late drives: B beyond what m/T bears is unstable, whatever K",
        ("wall.damping=200 N s/m",),
        up(CYCLE, ACTIVE, MARGIN),
        (
            fix("wall.stiffness=50 N/m", left=up(CYCLE, ACTIVE, MARGIN)),
            fix("wall.damping=40 N s/m"),
        ),
    ),
    Case(
        "a wall with the largest damping",
        "every touch throws the device out with the register's largest force",
        ("wall.damping=1e6 N s/m",),
        up(CYCLE, ACTIVE, CLAMPED, MARGIN),
        (fix("wall.damping=40 N s/m"),),
    ),
)

TIME = (
    Case(
        "a period far too long",
        "50 ms: (T/2 + L) bears 40 N/m passively, 269 N/m stably",
        ("budget.period=50 ms", "frames=100"),
        up(CYCLE, ACTIVE, MARGIN),
        (
            fix("wall.stiffness=40 N/m"),
            fix("device.dynamics.damping=15 N s/m"),
            fix("budget.period=2 ms", "frames=1500"),
        ),
    ),
    Case(
        "a delay of ten periods",
        "20 ms: 48 N/m passively, 371 N/m stably",
        ("host.delay.time=20 ms",),
        up(CYCLE, ACTIVE, MARGIN),
        (
            fix("host.delay.time=1 ms"),
            fix("wall.stiffness=100 N/m"),
            fix("device.dynamics.damping=12 N s/m"),
        ),
    ),
    Case(
        "a delay of 500 periods",
        "1 s: jumps from place to place once a second, and rests between",
        ("host.delay.time=1 s", "frames=4000"),
        up(ACTIVE, CYCLE),
        (fix("host.delay.time=1 ms"),),
    ),
)
