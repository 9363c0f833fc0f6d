"""hal/can/joulepath.dbc: the committed codec is what it makes, raw values are fixed point, signals do not overlap, and
the protection is that of the firmware."""
import itertools
import math
import re

import cantools
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

CAN = ROOT / "hal/can"
DATABASE = cantools.database.load_file(CAN / "joulepath.dbc")
SIGNALS = [(message, signal) for message in DATABASE.messages for signal in message.signals]
HAND_WRITTEN_IDS = re.compile(r"JP_DATA_ID_(\w+) = (0x[0-9A-F]+)")
# enum jp_data_id names a sample as a whole.
NAMES = {"SAMPLE": "CurrentSensors"}


def test_the_codec_is_fresh(tmp_path):
    assert not run_tool("design.can_codec", "--output", tmp_path).returncode
    for name in ("jp_can.h", "jp_can.c"):
        assert (tmp_path / name).read_bytes() == (CAN / name).read_bytes(), f"{name} is stale: make codec"


@pytest.mark.parametrize("text", ["nonsense", 'VERSION "1"\nBO_ 16 A: 8 ECU\n SG_ B : 60|8@1+ (1,0) [0|1] "" C\n'])
def test_a_dbc_that_is_not_valid(tmp_path, text):
    path = tmp_path / "bad.dbc"
    path.write_text(text)
    result = run_tool("design.can_codec", "--dbc", path, "--output", tmp_path / "out")
    assert_one_line_error(result, "bad.dbc")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("message, signal", SIGNALS, ids=lambda part: part.name)
def test_the_raw_value_is_fixed_point(message, signal):
    mantissa, _ = math.frexp(signal.scale)
    assert mantissa == 0.5, f"scale {signal.scale} is no power of two"
    assert signal.offset == 0
    assert signal.byte_order == "little_endian"
    assert signal.minimum < signal.maximum
    lowest = -(1 << signal.length - 1) if signal.is_signed else 0
    highest = (1 << signal.length - signal.is_signed) - 1
    # 64 bits are more than a double holds.
    assert lowest <= signal.minimum / signal.scale and signal.maximum / signal.scale <= highest + (signal.length == 64)


def test_a_signal_of_one_name_has_one_unit():
    units = {}
    for _, signal in SIGNALS:
        units.setdefault(signal.name, set()).add(signal.unit)
    assert {name: unit for name, unit in units.items() if len(unit) > 1} == {}


@pytest.mark.parametrize("message", DATABASE.messages, ids=lambda message: message.name)
def test_signals_neither_overlap_nor_leave_the_frame(message):
    bits = [set(range(signal.start, signal.start + signal.length)) for signal in message.signals]
    assert all(a.isdisjoint(b) for a, b in itertools.combinations(bits, 2))
    assert max(max(signal) for signal in bits) < 8 * message.length <= 64


def test_messages_have_an_id_and_a_name_of_their_own():
    ids = [message.frame_id for message in DATABASE.messages]
    assert len(set(ids)) == len(ids) and max(ids) <= 0x7FF
    assert not any(message.is_extended_frame for message in DATABASE.messages)


def data_ids():
    return {message.name: message.dbc.attributes["E2EDataId"].value for message in DATABASE.messages
            if "E2EDataId" in message.dbc.attributes}


def test_data_ids_are_those_of_the_firmware():
    named = dict(HAND_WRITTEN_IDS.findall((CAN / "messages.h").read_text()))
    in_firmware = {NAMES.get(name, name.title().replace("_", "")): int(value, 16) for name, value in named.items()}
    assert data_ids() == in_firmware
    assert len(set(in_firmware.values())) == len(in_firmware)


# Where the firmware enumerates what a signal tells, and names that differ there.
ENUMERATIONS = [
    ("EcuStatus", "State", "hal/app/ecu_robot.h", "jp_ecu_state", "JP_ECU_", {}),
    ("EcuLosses", "StandRefusal", "hal/app/ecu_robot.h", "jp_refusal", "JP_REFUSAL_",
     {"CONFLICT": "OtherController", "STEEP": "TooSteep"}),
    ("LearnerStatus", "Cause", "include/joulepath/learner.h", "jp_cause", "JP_CAUSE_", {}),
    ("LearnerStatus", "Evidence", "include/joulepath/evidence.h", "jp_evidence", "JP_EVIDENCE_", {}),
    ("LearnerStatus", "Stored", "hal/storage/parameters.h", "jp_stored", "JP_STORED_", {}),
    ("NavigationStatus", "Answer", "hal/app/navigation.h", "jp_goal_answer", "JP_GOAL_", {}),
]


@pytest.mark.parametrize("message, signal, header, enumeration, prefix, others", ENUMERATIONS,
                         ids=lambda part: part if isinstance(part, str) else "")
def test_enumerations_are_those_of_the_firmware(message, signal, header, enumeration, prefix, others):
    body = re.search(rf"enum {enumeration} {{(.*?)}};", (ROOT / header).read_text(), re.DOTALL)[1]
    names = re.findall(rf"\b{prefix}(\w+)", re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL))
    choices = DATABASE.get_message_by_name(message).get_signal_by_name(signal).choices
    assert [str(choices[value]) for value in sorted(choices)] == [
        others.get(name, name.title().replace("_", "")) for name in names]
    assert sorted(choices) == list(range(len(names)))


def test_protected_messages_begin_with_crc_and_counter():
    """Those, and no others, have them; only such frames command anything."""
    for message in DATABASE.messages:
        layout = {signal.name: (signal.start, signal.length) for signal in message.signals}
        protected = {"Crc": (0, 8), "Counter": (8, 4)}
        held = {name: place for name, place in layout.items() if name in protected}
        assert held == (protected if message.name in data_ids() else {})
        if "OPERATOR" in message.senders or message.name == "MotorCommand":
            assert message.name in data_ids()


def test_what_the_operator_sends_most_often_is_cyclic():
    assert DATABASE.get_message_by_name("OperatorCommand").cycle_time == 100
    assert DATABASE.get_message_by_name("Goal").cycle_time == 100
    assert DATABASE.get_message_by_name("MotorCommand").cycle_time == 1
