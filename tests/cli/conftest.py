"""Folders to call the command in, and the command itself."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.helpers import Answer, call, scene

TABLES = {
    "lines.csv": b"# source: made up\nlength_ratio,sag_printed\n1.1,0.50\n1.2,0.73\n",
    "longer.csv": b"length_ratio,sag_printed\n1.1,0.50\n1.2,0.73\n1.3,0.92\n",
    "spans.csv": b"span [kg]\n2.5\n",
    "strange_unit.csv": b"span [smoot]\n2.5\n",
    "broken_unit.csv": b"span [m (]\n2.5\n",
    "ragged.csv": b"length_ratio,sag_printed\n1.1,0.50\n1.2\n",
    "words.csv": b"length_ratio\n1.1\nlong\n",
    "python_number.csv": b"length_ratio\n1_1\n",
    "overflow.csv": b"length_ratio\n1.1e999\n",
    "gap.csv": b"length_ratio,sag_printed\n1.1,0.50\n,0.73\n",
    "head_only.csv": b"length_ratio,sag_printed\n",
    "empty.csv": b"",
    "twice.csv": b"length_ratio,length_ratio\n1.1,1.2\n",
    "bad_head.csv": b"length ratio\n1.1\n",
    "latin.csv": "length_ratio\n1.1 \N{MICRO SIGN}\n".encode("latin-1"),
    "binary.csv": bytes(range(256)),
    "huge_cell.csv": b"length_ratio\n" + b"1" * 200_000 + b"\n",
}

TINY = scene(
    title="Slack and taut lines",
    design="{grid: {rise: [0 m, 10 cm], length_ratio: [0.9, 1.1, 1.2, 1.3]}}",
    methods="{exact: {solver: catenary_exact, options: {nodes: 5}}, parabolic: {solver: catenary_parabolic,"
    " options: {nodes: 5}, ignores: [rise]}}",
    reference="exact",
    outputs="[sag, max_tension, profile]",
    figures="{sag: {kind: curves, x: length_ratio, y: exact.sag, each: rise}}",
)


@pytest.fixture
def ask(capsysbinary: pytest.CaptureFixture[bytes]) -> Callable[..., Answer]:
    """Call the command in this process."""

    def command(*arguments: object) -> Answer:
        capsysbinary.readouterr()
        code = call(tuple(map(str, arguments)))
        out, err = capsysbinary.readouterr()
        return Answer(code, out, err.decode())

    return command


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with tables, and a table and a scene outside of it that must stay out of reach."""
    folder = tmp_path / "here"
    (folder / "tables" / "folder.csv").mkdir(parents=True)
    for name, content in TABLES.items():
        (folder / "tables" / name).write_bytes(content)
    (tmp_path / "outside.csv").write_bytes(TABLES["lines.csv"])
    (folder / "tables" / "link.csv").symlink_to(tmp_path / "outside.csv")
    (folder / "linked").symlink_to(tmp_path)
    (folder / "good.yaml").write_text(scene())
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `tiny.yaml` and, in `results`, what a run of it has made: two of its lines are too short."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "tiny.yaml").write_text(TINY)
    assert call(("run", str(folder / "tiny.yaml"), "--out", str(folder / "results"))) == 1
    return folder


@pytest.fixture
def in_study(study: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, as the working folder."""
    monkeypatch.chdir(study)
    return study
