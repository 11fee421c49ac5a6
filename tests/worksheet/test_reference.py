"""The function reference is that of the registry."""

from addin.reference.functions_page import PAGE, reference


def test_the_page_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == reference()
