"""Numbers as options give them."""

from __future__ import annotations


def numbers_of(option: str, text: str, count: int) -> list[float]:
    """Numbers separated by commas or blanks."""
    from rttrr_pin.errors import InputError
    from rttrr_pin.urdf.checks import NUMBER

    words = text.replace(",", " ").split()
    numbers = [float(word) for word in words] if all(NUMBER.fullmatch(word) for word in words) else []
    if len(numbers) != count:
        example = ",".join("0" for _ in range(count))
        raise InputError(f"{option} is {text!r}: expected {count} numbers separated by commas, such as {example}")
    return numbers
