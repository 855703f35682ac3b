"""docs/commands.md is generated from the help of every command."""

from tools.commands_page import PAGE, page


def test_the_page_of_commands_is_current() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run python -m tools.commands_page"
