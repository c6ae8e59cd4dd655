"""MAT-files: those that are damaged, too deep or too large are refused in one line."""

from contextlib import suppress

import numpy as np
import pytest

from connectors.exports.fault import RecordingError
from connectors.exports.reading import names_of_loops, read_export
from connectors.exports.tables import mat5, matlab
from tests.exports.matfiles import deep, saved, structures, vectors
from tests.exports.truth import LOOPS


def refusal(path, content):
    path.write_bytes(content)
    with pytest.raises(RecordingError) as refused:
        read_export(path)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_the_names_of_loops_are_known_without_their_values(tmp_path):
    path = tmp_path / "plant.mat"
    path.write_bytes(structures())
    assert names_of_loops(path) == tuple(loop.name for loop in LOOPS)


def test_structures_of_an_array_are_numbered(tmp_path):
    path = tmp_path / "many.mat"
    path.write_bytes(saved({"loops": [{"OP": loop.op, "PV": loop.pv, "Ts": 5.0} for loop in LOOPS]}))
    export = read_export(path)
    assert export.loops.names == ("loops1", "loops2", "loops3")
    np.testing.assert_allclose([loop.pv for loop in export.loops], [loop.pv for loop in LOOPS])


def test_no_stack_is_deep_enough(tmp_path):
    assert "more than 20 structures within each other" in refusal(tmp_path / "a.mat", deep(3000))


def test_what_unpacks_without_end_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(matlab, "MOST_UNPACKED", 1 << 20)
    assert "too large when unpacked" in refusal(tmp_path / "a.mat", saved({"OP": np.zeros(1 << 20)}))


def test_so_many_fields_take_too_much_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(mat5, "MOST_VALUES", 100)
    fields = {f"f{k}": {} for k in range(200)}
    assert "more than 100 variables and fields" in refusal(tmp_path / "a.mat", saved({"s": fields}))


def test_a_name_is_no_path(tmp_path):
    content = saved({"abcd": {"OP": LOOPS[0].op, "PV": LOOPS[0].pv, "Ts": 5.0}}, packed=False)
    path = tmp_path / "a.mat"
    path.write_bytes(content.replace(b"abcd", b"/../"))
    assert [loop.path for loop in read_export(path).loops] == [path / "____"]


def test_another_format_within_is_named(tmp_path):
    content = bytearray(vectors())
    content[124:126] = b"\x00\x02"
    assert "version 7.3: save it with -v7" in refusal(tmp_path / "a.mat", bytes(content))


def test_vectors_of_a_loop_are_as_long_as_each_other_and_other_loops_are_read(tmp_path):
    whole = {"OP": LOOPS[0].op, "SP": LOOPS[0].sp, "PV": LOOPS[0].pv, "Ts": 5.0}
    cut = whole | {"PV": whole["PV"][1:]}
    words = "PV has 239 values, expected 240 as in the others"
    assert words in refusal(tmp_path / "a.mat", saved(cut))
    path = tmp_path / "b.mat"
    path.write_bytes(saved({"one": whole, "two": cut}))
    export = read_export(path)
    assert export.loops.names == ("one",)
    assert any(words in each for each in export.problems)


@pytest.mark.parametrize("held", [{"note": "text"}, {"x": 1.0}])
def test_no_vector_no_loop(tmp_path, held):
    assert "holds no vectors of numbers" in refusal(tmp_path / "a.mat", saved(held))


def test_damage_is_refused_or_harmless(tmp_path):
    rng = np.random.default_rng(0)
    whole = [vectors(), structures()]
    for k in range(400):
        content = bytearray(whole[k % 2])
        if k % 3:
            for at in rng.integers(0, len(content), 3):
                content[at] = rng.integers(256)
        else:
            del content[rng.integers(4, len(content)) :]
        path = tmp_path / f"{k}.mat"
        path.write_bytes(bytes(content))
        with suppress(RecordingError):
            read_export(path)
