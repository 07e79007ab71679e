"""How a study ends where it cannot go on, by the exit statuses of hvp itself."""

HELD = 0
NOT_HELD = 1
WRONG_INPUT = 2
FAILED = 3


class InputError(Exception):
    """The input is wrong: one line that says where, and what was expected. Exit status 2."""


class StudyError(Exception):
    """Anything else that a user is told of in one line: a full disk, say. Exit status 3."""
