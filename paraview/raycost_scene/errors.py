"""What goes wrong."""


class RaycostError(RuntimeError):
    """A view that is no scene, a program that is missing or fails; the message says why."""
