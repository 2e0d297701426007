"""One kind of error, with the exit codes that all tools share."""

USAGE = 2
FILE_ACCESS = 3
INVALID_CONTENT = 4
NO_GPU = 6
INTERNAL = 70
# As shells have them.
CANNOT_RUN = 127
SIGNALLED = 128  # and the signal's number


class PlanError(Exception):
    """Ends the program with a message that names the file, what was found and the remedy."""

    def __init__(self, exit_code, message):
        super().__init__(message)
        self.exit_code = exit_code
