"""The runner of examples finds what is wrong with them."""

from __future__ import annotations

import pytest

from tests.docs.pages import Block, blocks, commands, pages
from tests.docs.runner import Runner, _compare

WRONG = (
    ("python", (), "1 / 0", ZeroDivisionError),
    ("python", (), "import warnings; warnings.warn('deprecated', stacklevel=1)", UserWarning),
    ("sh", (), "flexstage nonsense", pytest.fail.Exception),
    ("sh", ("exit=2",), "flexstage --help", pytest.fail.Exception),
    ("sh", (), "make nonsense", AssertionError),
    ("sh", (), "rm -r stage", AssertionError),
    ("toml", (), "name = 'a'", AssertionError),
    ("rust", (), "", AssertionError),
)


@pytest.mark.parametrize(("language", "words", "text", "error"), WRONG, ids=lambda value: str(value)[:30])
def test_what_does_not_work_fails(language, words, text, error, tmp_path):
    with pytest.raises(error):
        Runner(tmp_path).run(Block("page.md", 1, language, words, text))


def test_other_output_fails(tmp_path):
    with pytest.raises(pytest.fail.Exception, match="but this is printed"):
        _compare(Block("page.md", 1, "text", ("output",), "mass 2.0 kg"), "mass 2.5 kg")
    _compare(Block("page.md", 1, "text", ("output",), "mass ... kg"), "mass   2.5\nkg")


def test_pieces_are_laid_over_a_file_that_stays(tmp_path):
    whole = 'format = "flexstage 1"\nname = "a"\n'
    (tmp_path / "a.toml").write_text(whole)
    with pytest.raises(Exception, match="unit missing"):
        Runner(tmp_path).run(Block("page.md", 1, "toml", ("into=a.toml",), "max_mode_frequency = 3"))
    assert (tmp_path / "a.toml").read_text() == whole


def test_continued_lines_are_one_command():
    assert commands("# a\nflexstage new \\\n    a.toml\n\nflexstage check a.toml  # mind\n") == [
        "flexstage new a.toml",
        "flexstage check a.toml  # mind",
    ]


def test_pages_and_blocks_are_found():
    assert {"README.md", "docs/models.md", "docs/decisions/0001-currency.md"} <= set(pages())
    assert [block.language for block in blocks("README.md")].count("python") == 1
