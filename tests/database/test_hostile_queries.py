"""More than two hundred hostile strings, each in every place of a query: nothing is executed and nothing written.

A process of its own asks them all under an audit hook, which sees what the interpreter does: code that is compiled or
executed, processes that are started, files that are opened for writing, sockets.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

from tests.cli.helpers import tree

PAYLOADS = [
    "__import__('os').system('touch pwned')",
    'exec(\'open("pwned", "w")\')',
    "eval('1+1')",
    "open('pwned', 'w').write('x')",
    "().__class__.__bases__[0].__subclasses__()",
    "sag.__class__",
    "@pd.compat.os.system('touch pwned')",
    "@__builtins__.exec('x=1')",
    "`touch pwned`",
    "$(touch pwned)",
    "; touch pwned",
    "| touch pwned",
    "&& touch pwned",
    "lambda: 0",
    "[x for x in (1,)]",
    "{'a': 1}",
    "f'{sag}'",
    "%s%n%x",
    "{0.__class__}",
    "'; DROP TABLE scenarios; --",
    "1 UNION SELECT * FROM read_csv('/etc/passwd')",
    "COPY (SELECT 1) TO 'pwned'",
    "ATTACH 'pwned.db'",
    "../../../etc/passwd",
    "/etc/passwd",
    "file:///etc/passwd",
    "http://127.0.0.1:1/x",
    "\\\\host\\share",
    "!touch pwned",
    "%run pwned.py",
    "import os",
    "os.remove('spans.nc')",
    "sag := 3",
    "sag = 3",
    "<script>alert(1)</script>",
    "\x00",
    "\x1b[2J",
    "\ud7ff\uffff",
    "sag\n; import os",
    "sag > 1 # comment",
    "/* */",
    "sag > 1 m; touch pwned",
    "9" * 400,
    "1e999",
    "-" * 900,
    "(" * 400 + "1" + ")" * 400,
    "not " * 200 + "sag > 1",
    "sag > 1 and " * 60 + "sag > 1",
    "a" * 5000,
    "\N{MATHEMATICAL BOLD SMALL E}xec('x')",
    '=HYPERLINK("http://127.0.0.1")',
    "~sag",
]
# How a string is dressed, so that it comes past a reader that looks only at one end.
DRESSES = ["{}", "sag > 1 and {}", "{} > 1", "min(sag, {})", "sag > '{}'"]
QUERIES = [dress.format(payload) if "{}" in dress else dress for payload in PAYLOADS for dress in DRESSES]

SCRIPT = """
import json, sys
from cablesim import open_study
from cablesim.errors import CablesimError
from tests.faults.watch import watching

results, queries = sys.argv[1], json.load(sys.stdin)
study = open_study(results)
# What is imported at the first use of each part is imported before anybody watches.
study.query("spans", "sag > 1 m and method == exact", ["sag"], {"span": "20 m"}, "sag desc", 3)
study.query("*", "span == 23 m")

outcomes = {"answered": 0, "refused": 0, "other": []}

seen = []

def ask(*arguments):
    try:
        with watching(executing=True) as found:
            answer(*arguments)
    finally:
        seen.extend(found)

def answer(*arguments):
    try:
        study.query(*arguments)
        outcomes["answered"] += 1
    except CablesimError:
        outcomes["refused"] += 1
    except Exception as problem:
        outcomes["other"].append(repr(problem)[:200])

import warnings
warnings.simplefilter("ignore")
for text in queries:
    ask("spans", text)
    ask(text, None)
    ask("spans", None, [text])
    ask("spans", None, [], {text: 1.0})
    ask("spans", None, [], {"span": text})
    ask("spans", None, [], None, text)
# The watch is worth something only if it sees.
with watching(executing=True) as found:
    exec("x = 1")
    open("written", "w").close()
assert [event.split(" ", 1)[0] for event in found] == ["compile", "exec", "open"], found
print(json.dumps({"seen": seen, **outcomes}))
"""


def test_no_string_is_executed_and_nothing_is_written(copy: Path, tmp_path: Path) -> None:
    assert len(QUERIES) >= 200
    before = tree(copy)
    work = tmp_path / "work"
    work.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(copy)],
        input=json.dumps(QUERIES),
        cwd=work,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    told = json.loads(done.stdout)
    assert told["seen"] == []
    assert told["other"] == []
    assert told["answered"] + told["refused"] == 6 * len(QUERIES)
    assert told["refused"] > 5 * len(QUERIES)
    assert [path.name for path in work.iterdir()] == ["written"]
    assert tree(copy) == before
