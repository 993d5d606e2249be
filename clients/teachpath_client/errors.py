"""What a client raises on purpose."""


class ClientError(Exception):
    """The station cannot be reached, or refused; the text is a sentence for the operator."""
