# SPDX-License-Identifier: MIT
"""Each option of the program is a keyword of a function, and no keyword is anything else."""

from __future__ import annotations

import inspect
import re
import subprocess
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import meshhier
from meshhier.options import COMMANDS, LEFT_OUT, SETTLED, Files, option_name, option_words, spoken

FUNCTIONS: dict[str, list[Callable[..., Any]]] = {
    **{name: [getattr(meshhier, name)] for name in COMMANDS if name != "query"},
    "query": [meshhier.Hierarchy.nearest, meshhier.Hierarchy.rays],
    "inspect": [meshhier.inspect, meshhier.inspect_objects],
    "task": [meshhier.task, meshhier.task_status],
}
WITHOUT_FUNCTION = {
    "serve": "a service",
    "completion": "for shells",
    "manual": "for people",
}
GIVEN_ELSEWHERE = {"task": {"status"}, "query": {"headers"}}  # by task_status(), and by open()
CALLBACKS = {"progress", "warning", "account"}


def said(*words: str) -> list[str]:
    """What a shell is told to complete after these words."""
    run = subprocess.run([meshhier.find_program(), "complete", "meshhier", *words], check=True, capture_output=True, text=True)
    return [line.split("\t")[0] for line in run.stdout.splitlines()[1:]]


def options_of(command: str) -> set[str]:
    return {word for word in said(command, "--") if "=" not in word}


def keywords_of(command: str) -> set[str]:
    parameters = [one for function in FUNCTIONS[command] for one in inspect.signature(function).parameters.values()]
    return {one.name for one in parameters if one.kind == one.KEYWORD_ONLY} - CALLBACKS


def test_each_command_is_a_function() -> None:
    assert set(said("")) - {"--help", "--version"} <= set(COMMANDS) | set(WITHOUT_FUNCTION)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_option_is_a_keyword(command: str) -> None:
    known = {option_name(keyword, option): keyword for keyword, option in COMMANDS[command].items()}
    options = options_of(command) - SETTLED - set(LEFT_OUT.get(command, {}))
    assert len(options) > 0
    missing = sorted(options - set(known))
    assert not missing, f"meshhier/options.py has no keyword for {missing}"
    assert {known[option] for option in options} - GIVEN_ELSEWHERE.get(command, set()) <= keywords_of(command), "the function lacks it"
    assert keywords_of(command) <= set(COMMANDS[command]), "options.py lacks it"
    older = sorted(set(known) - options)
    if older == ["--update"]:
        pytest.skip("this program has no build --update yet")
    assert not older, f"the program has no {older}"


@pytest.mark.parametrize("command", COMMANDS)
def test_flags_are_flags(command: str) -> None:
    help_text = subprocess.run([meshhier.find_program(), command, "--help"], check=True, capture_output=True, text=True).stdout
    for keyword, option in COMMANDS[command].items():
        line = re.search(rf"^ +{option_name(keyword, option)}(?: (?!Excludes:|Needs:)(\S+))?(?= |\n)", help_text, re.MULTILINE)
        if line is None:
            assert keyword == "update"
            continue
        assert option.is_flag == (line[1] is None), line[0]


def test_defaults_give_no_option() -> None:
    for command, functions in FUNCTIONS.items():
        for function in functions:
            given = {name: one.default for name, one in inspect.signature(function).parameters.items() if one.default is not one.empty}
            with Files() as files:
                assert option_words(command, given, files) == [], function


VALUES: list[tuple[str, dict[str, Any], list[str]]] = [
    ("export", {"level": 3}, ["--level=3"]),
    ("export", {"level": np.int64(0), "error": np.float32(0.5)}, ["--level=0", "--error=0.5"]),
    ("export", {"node": meshhier.Node(3, 5)}, ["--node=3/5"]),
    ("export", {"node": (3, 5), "outline": False, "clip": True}, ["--node=3/5", "--clip"]),
    ("export", {"box": ((-1, 0, 0), np.array([1, 2, 3.5]))}, ["--box", "-1.0,0.0,0.0", "1.0,2.0,3.5"]),
    ("export", {"box": ((-np.inf, 0, 0), (1, 2, np.inf))}, ["--box", "-1e+300,0.0,0.0", "1.0,2.0,1e+300"]),
    ("export", {"node": "3/5"}, ["--node=3/5"]),
    ("export", {"object": "-a"}, ["--object=-a"]),
    ("export", {"object": ["a", "b/"], "where": "area > 1"}, ["--object=a", "--object=b/", "--where=area > 1"]),
    ("export", {"align": (15, 15), "dsm": Path("-x.tif")}, ["--align=15,15", "--dsm=./-x.tif"]),
    ("preview", {"size": (640, 480), "view": (-20, 10)}, ["--size=640x480", "--view=-20,10"]),
    ("preview", {"size": "640x480", "view": "front", "memory_budget": "2GiB"}, ["--memory-budget=2GiB", "--size=640x480", "--view=front"]),
    ("draw", {"scale": 50, "grid": True}, ["--scale=1:50", "--grid"]),
    ("draw", {"scale": "2:1", "grid": 0.5, "cut_height": [1, 2.5]}, ["--cut-height=1,2.5", "--scale=2:1", "--grid=0.5"]),
    ("draw", {"section": ((0, 4), (20, 4)), "plane": (1, 0, 0, -40)}, ["--section", "0,4", "20,4", "--plane=1,0,0,-40"]),
    ("build", {"settings": {"a.b": 3, "c": "x", "d": True}}, ["--set=a.b=3", "--set=c=x", "--set=d=true"]),
    ("build", {"settings": {"a": np.int64(3), "b": Path("x y"), "c": np.bool_(True), "d": {"e": [np.float64(0.5)]}}}, ["--set=a=3", "--set=b=x y", "--set=c=true", '--set=d={"e": [0.5]}']),
    ("build", {"settings": {"a": np.array([1, 2])}}, ["--set=a=[1, 2]"]),
    ("verify", {"input": ["a.ply", Path("b.ply")], "error": False}, ["--input=a.ply", "--input=b.ply"]),
    ("inspect", {"prefix": True}, ["--objects"]),
]  # fmt: skip


@pytest.mark.parametrize("command, given, words", VALUES)
def test_values_are_words(command: str, given: dict[str, Any], words: list[str]) -> None:
    with Files() as files:
        # a list's option stands before each of its values
        assert sorted(option_words(command, given, files)) == sorted(words)


@pytest.mark.parametrize(
    "command, given",
    [
        ("export", {"level": True}), ("export", {"clip": 1}), ("export", {"box": ((0, 0, 0), (1, 1))}), ("export", {"box": (0, 1)}), ("export", {"node": 3}),
        ("export", {"box": ((1, 1, 1), (0, 0, 0))}), ("export", {"node": "root"}),
        ("export", {"error": None, "level": []}), ("draw", {"plane": (1, 2, 3)}), ("preview", {"size": (1, 2, 3)}), ("build", {"settings": "a=b"}), ("build", {"settings": {"a": {1, 2}}}),
        ("build", {"within": 3}), ("compare", {"transform": [[1, 0], [0, 1]]}), ("export", {"headers": {"a": "b\r\nc: d"}}), ("export", {"headers": ["no"]}),
    ],
)  # fmt: skip
def test_values_of_another_kind_are_refused(command: str, given: dict[str, Any]) -> None:
    keyword = list(given)[-1]
    with Files() as files, pytest.raises(meshhier.UsageError, match=f"^({keyword}: expected|an? {keyword} is)"):
        option_words(command, given, files)


def test_secrets_are_on_no_command_line_and_in_no_message() -> None:
    with Files() as files:
        (word,) = option_words("export", {"headers": {"Authorization": "Bearer s3cret"}}, files)
        path = Path(word[len("--header=@") :])
        assert "s3cret" not in word and path.read_text() == "Authorization: Bearer s3cret\n"
        assert path.parent.stat().st_mode & 0o077 == 0
        with pytest.raises(meshhier.UsageError) as refused:
            option_words("export", {"headers": {"Authorization": "s3cret\n"}}, files)
        assert "s3cret" not in str(refused.value)
    assert not path.exists()


def test_messages_are_for_callers() -> None:
    assert spoken("a.hier is already there; --force replaces it", "build") == "a.hier is already there; force=True replaces it"
    assert spoken("holds the work of ..., but x; --restart throws it away", "build").endswith("restart=True throws it away")
    assert spoken("--memory-budget: expected a size", "export") == "memory_budget=: expected a size"
    assert spoken("or remove it (meshhier clean --remove a b.hier)", "progressive") == 'or remove it (meshhier.clean("a", "b.hier", remove=True))'
    assert spoken("run `meshhier task w leaves --index 3` first", "task") == 'run `meshhier.task("w", "leaves", index=3)` first'
    assert spoken('nix has no plan: "meshhier plan MESH --work nix --tasks N" makes one', "task") == 'nix has no plan: "meshhier.plan(MESH, work="nix", tasks=N)" makes one'
    assert spoken("a file named a--force.ply, and --no-such-thing", "build") == "a file named a--force.ply, and --no-such-thing"
