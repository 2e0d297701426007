"""One kind of error, with the exit codes that all tools share."""

USAGE = 2
FILE_ACCESS = 3
INVALID_CONTENT = 4


class PlanError(Exception):
    """Ends the program with a message that names the file, what was found and the remedy."""

    def __init__(self, exit_code, message):
        super().__init__(message)
        self.exit_code = exit_code
