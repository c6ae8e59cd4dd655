"""Loops by the names that control systems give their tags."""

import pytest

from agent.settings.tag_names import NamedTag, groups_by_convention, groups_by_pattern


def tags(*names):
    return [NamedTag(f"node of {name}", (name,)) for name in names]


def nodes(group):
    return {role: tag.names[0] for role, tag in group.tags.items()}


@pytest.mark.parametrize(
    ("names", "loop", "roles"),
    [
        (
            "A1/FIC101/PID1/PV.CV A1/FIC101/PID1/OUT.CV A1/FIC101/PID1/SP.CV A1/FIC101/PID1/MODE.ACTUAL",
            "FIC101",
            4,
        ),
        ("FIC101/PID1/PV/CV FIC101/PID1/OUT/CV FIC101/PID1/SP/CV", "FIC101", 3),
        ("FIC101.PIDA.PV FIC101.PIDA.OP FIC101.PIDA.SP FIC101.PIDA.MODE", "FIC101", 4),
        ("FIC101.DACA.PV FIC101.DACA.OP", "FIC101", 2),
        ("Unit 3/FIC-101/pv Unit 3/FIC-101/op Unit 3/FIC-101/sp", "FIC-101", 3),
        ("FCS0101!FIC101.PV FCS0101!FIC101.MV FCS0101!FIC101.SV FCS0101!FIC101.MODE", "FCS0101!FIC101", 4),
        ("CPD1:FIC101.MEAS CPD1:FIC101.OUT CPD1:FIC101.SPT", "FIC101", 3),
        ("FIC101/PV#Value FIC101/MV#Value FIC101/SP#Value", "FIC101", 3),
        ("FIC_101_PV FIC_101_CO FIC_101_SP", "FIC_101", 3),
        ("FIC101/ME FIC101/OUT FIC101/SP", "FIC101", 3),
        ("FIC101/PV_IN FIC101/LMN", "FIC101", 2),
        ("Program:Main.FIC101.PV Program:Main.FIC101.CVEU Program:Main.FIC101.SP", "FIC101", 3),
        ("FIC101/ProcessValue FIC101/Output FIC101/Setpoint", "FIC101", 3),
    ],
)
def test_the_names_of_a_system(names, loop, roles):
    unit = names.split(" ") if "Unit" not in names else names.replace("Unit 3", "Unit~3").split(" ")
    (group,) = groups_by_convention(tags(*[name.replace("~", " ") for name in unit]))
    assert group.name == loop
    assert len(group.tags) == roles


def test_the_output_is_distinguished_from_the_measured_valve():
    (group,) = groups_by_convention(tags("F1.PV", "F1.MV", "F1.OP", "F1.SP"))
    assert nodes(group) == {"pv": "F1.PV", "op": "F1.OP", "sp": "F1.SP"}


def test_what_is_no_loop_is_left_out():
    assert (
        groups_by_convention(tags("TI5.PV", "XV7.OP", "F1/PV/EURange", "F2/OP/EURange", "PV", "OP", "/PV"))
        == ()
    )


def test_loops_of_one_name_get_distinct_names():
    found = groups_by_convention(
        tags(
            "A/FIC1/PID1/PV.CV",
            "A/FIC1/PID1/OUT.CV",
            "A/FIC1/PID2/PV.CV",
            "A/FIC1/PID2/OUT.CV",
            "A/TIC/PV",
            "A/TIC/OP",
            "B/TIC/PV",
            "B/TIC/OP",
        )
    )
    assert [group.name for group in found] == ["FIC1-PID1", "FIC1-PID2", "A-TIC", "B-TIC"]


def test_names_are_fit_for_the_configuration_and_differ():
    found = groups_by_convention(tags("Unit 1+2/#A/PV", "Unit 1+2/#A/OP", "x y_PV", "x y_OP", "y/PV", "y/OP"))
    names = [group.name for group in found]
    assert len(set(names)) == 3
    assert not any(set(name) & set(" /+#.") for name in names)


def test_patterns_of_ones_own():
    patterns = {"pv": "*/Istwert", "op": "*/Stellgroesse", "sp": "Soll.*"}
    found = groups_by_pattern(
        tags("K1/F1/istwert", "K1/F1/Stellgroesse", "Soll.K1/F1", "K1/F2/Istwert", "/Stellgroesse"), patterns
    )
    (group,) = found
    assert group.name == "F1"
    assert nodes(group) == {"pv": "K1/F1/istwert", "op": "K1/F1/Stellgroesse", "sp": "Soll.K1/F1"}


def test_the_first_of_a_tags_names_that_fits_counts():
    flat = [NamedTag("1", ("Data/Value1", "F1.PV")), NamedTag("2", ("Data/Value2", "F1.OP"))]
    (group,) = groups_by_convention(flat)
    assert {role: tag.address for role, tag in group.tags.items()} == {"pv": "1", "op": "2"}
