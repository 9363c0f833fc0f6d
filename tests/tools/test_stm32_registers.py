"""The registers of hal/stm32f4 against the manufacturer's description of the family, an SVD file that pyOCD carries."""

import importlib.resources
import io
import re
import subprocess
import xml.etree.ElementTree
import zipfile
from pathlib import Path

import pytest
from elftools.elf.elffile import ELFFile

HEADER = "hal/stm32f4/stm32f405.h"
CORE_HEADER = "hal/cortex_m/cortex_m.h"
ADDRESSES = ("hal/stm32f4/peripherals.ld", "hal/cortex_m/cortex_m.ld")
SVD = "STM32F41x.svd"

# The common registers of all converters.
PERIPHERALS = {"ADC": "C_ADC"}

# Members that stand for several registers, and registers that the file lists twice, once for each use.
MEMBERS = {
    r"CCMR([12])": r"CCMR\1_Output",
    r"S\[(\d)\]\.(\w+)": r"S\1\2",
    r"([TR])\[(\d)\]\.IR": r"\1I\2R",
    r"([TR])\[(\d)\]\.D([TLH])R": r"\1D\3\2R",
    r"F\[(\d+)\]\.R([12])": r"F\1R\2",
}

# Bits: peripheral and register of PERIPHERAL_REGISTER.
REGISTERS = {
    "ADC_CCR": ("C_ADC", "CCR"),
    "TIM_CCMR1": ("TIM1", "CCMR1_Output", "CCMR1_Input"),
    "TIM_CCMR2": ("TIM1", "CCMR2_Output", "CCMR2_Input"),
    "DMA_CR": ("DMA2", "S0CR"),
    "CAN_TIR": ("CAN1", "TI0R"),
    "CAN_RIR": ("CAN1", "RI0R"),
    "CAN_TDTR": ("CAN1", "TDT0R"),
    "CAN_RDTR": ("CAN1", "RDT0R"),
}
# Bits that the file lacks; from the manual alone.
MISSING = {"PWR_CR_VOS", "ADC_SMPR1_SMP10", "ADC_SMPR1_SMP11", "ADC_SMPR1_SMP12"}
ALIASES = {"EXTI_LINE_SUPPLY": "EXTI_IMR_MR16"}
INSTANCES = {"TIM": "TIM1", "ADC": "ADC1", "DMA": "DMA2", "SPI": "SPI1", "CAN": "CAN1", "USART": "USART1"}


def number(element, name):
    return int(element.findtext(name), 0)


class Description:
    """Addresses, registers, fields and interrupts of the SVD file."""

    def __init__(self):
        data = importlib.resources.files("pyocd.debug.svd").joinpath("svd_data.zip").read_bytes()
        root = xml.etree.ElementTree.fromstring(zipfile.ZipFile(io.BytesIO(data)).read(SVD))
        self.peripherals = {p.findtext("name"): p for p in root.iter("peripheral")}
        self.interrupts = {i.findtext("name"): number(i, "value") for i in root.iter("interrupt")}

    def address(self, peripheral):
        return number(self.peripherals[peripheral], "baseAddress")

    def registers(self, peripheral):
        element = self.peripherals[peripheral]
        if element.find("registers") is None:
            element = self.peripherals[element.get("derivedFrom")]
        return {r.findtext("name"): r for r in element.iter("register")}

    def fields(self, peripheral, *registers):
        """First bit and width of each field."""
        elements = [f for name in registers for f in self.registers(peripheral)[name].iter("field")]
        return {f.findtext("name"): (number(f, "bitOffset"), number(f, "bitWidth")) for f in elements}


@pytest.fixture(scope="module")
def svd():
    return Description()


@pytest.fixture(scope="module")
def header():
    with open(HEADER, encoding="utf-8") as file:
        return file.read()


def objects(header):
    """Struct of each peripheral."""
    return {name: struct for struct, name in re.findall(r"^extern volatile struct (\w+) (\w+);", header, re.M)}


@pytest.fixture(scope="module")
def layout(header, tmp_path_factory):
    """Offset of each register in each struct, as the compiler lays it out."""
    directory = tmp_path_factory.mktemp("layout")
    source = f'#include "{HEADER}"\n#include "{CORE_HEADER}"\n' + "".join(
        f"volatile struct {struct} *pointer_{struct};\n" for struct in sorted({*objects(header).values(), "cortex_nvic"})
    )
    (directory / "layout.c").write_text(source)
    subprocess.run(
        ["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m4", "-g", "-I.", "-c", directory / "layout.c"]
        + ["-o", directory / "layout.o"],
        check=True,
    )
    with open(directory / "layout.o", "rb") as file:
        units = list(ELFFile(file).get_dwarf_info().iter_CUs())
        structs = [die for die in units[0].get_top_DIE().iter_children() if die.tag == "DW_TAG_structure_type"]
        return {text(die): dict(members(die)) for die in structs}


def text(die):
    return die.attributes["DW_AT_name"].value.decode()


def members(struct, prefix="", base=0):
    for die in struct.iter_children():
        offset = base + die.attributes["DW_AT_data_member_location"].value
        yield from elements(die.get_DIE_from_attribute("DW_AT_type"), prefix + text(die), offset)


def elements(kind, name, offset):
    while kind.tag == "DW_TAG_typedef":
        kind = kind.get_DIE_from_attribute("DW_AT_type")
    if kind.tag == "DW_TAG_array_type":
        element = kind.get_DIE_from_attribute("DW_AT_type")
        count = next(kind.iter_children()).attributes["DW_AT_upper_bound"].value + 1
        for i in range(count):
            yield from elements(element, f"{name}[{i}]", offset + i * size(element))
    elif kind.tag == "DW_TAG_structure_type":
        yield from members(kind, name + ".", offset)
    else:
        yield name, offset


def size(kind):
    while kind.tag == "DW_TAG_typedef":
        kind = kind.get_DIE_from_attribute("DW_AT_type")
    return kind.attributes["DW_AT_byte_size"].value


def addresses():
    text = "".join(Path(path).read_text("utf-8") for path in ADDRESSES)
    return {name: int(value, 0) for name, value in re.findall(r"^(\w+)\s*= (0x\w+);", text, re.M)}


def register_name(member):
    for pattern, name in MEMBERS.items():
        if re.fullmatch(pattern, member):
            return re.sub(pattern, name, member)
    return member


def test_every_peripheral_has_an_address(header):
    assert addresses().keys() >= objects(header).keys()


def test_registers_are_where_the_manufacturer_says(svd, header, layout):
    compared = 0
    for name, struct in objects(header).items():
        peripheral = PERIPHERALS.get(name, name)
        registers = svd.registers("TIM1" if struct == "stm32_tim" else peripheral)
        assert addresses()[name] == svd.address(peripheral), name
        for member, offset in layout[struct].items():
            if not member.startswith("reserved"):
                register = registers[register_name(member)]
                assert number(register, "addressOffset") == offset, f"{name}.{member}"
                compared += 1
    assert compared > 350


def test_interrupt_controller(svd, layout):
    """The file has it from its page on, and its priorities as words."""
    registers = svd.registers("NVIC")
    page = svd.address("NVIC")
    for member, offset in layout["cortex_nvic"].items():
        name, index = re.fullmatch(r"(\w+)\[(\d+)\]", member).groups()
        register = registers.get(f"IPR{int(index) // 4}" if name == "IPR" else name + index)
        if register is not None:
            byte = int(index) % 4 if name == "IPR" else 0
            assert page + number(register, "addressOffset") + byte == addresses()["NVIC"] + offset, member


def macros(header):
    """Name and value of each mask, name and first bit of each wider field."""
    masks = re.findall(r"^#define (\w+)\s+\(1U << (\d+)\)", header, re.M)
    wide = re.findall(r"^#define (\w+)\(n\)\s+\(\(uint32_t\)\(n\) << (\d+)\)", header, re.M)
    defined = re.findall(r"^#define ([A-Z]\w+)[ (]", header, re.M)
    assert len(masks) + len(wide) == len(defined)
    return [(name, int(bit), False) for name, bit in masks] + [(name, int(bit), True) for name, bit in wide]


def fields_of(svd, macro):
    prefix, register, field = ALIASES.get(macro, macro).split("_", 2)
    place = REGISTERS.get(f"{prefix}_{register}", (INSTANCES.get(prefix, prefix), register))
    return svd.fields(*place), field


def test_bits_are_where_the_manufacturer_says(svd, header):
    wrong = []
    for macro, bit, is_wide in macros(header):
        fields, field = fields_of(svd, macro)
        # Some wider fields are given bit by bit.
        found = fields.get(field) or fields.get(field + "0")
        if found is None or found[0] != bit or (found[1] > 1 and not is_wide):
            wrong.append(macro)
    assert set(wrong) == MISSING


def test_interrupts(svd, header):
    interrupts = re.findall(r"(\w+)_IRQn = (\d+)", header)
    assert interrupts
    for name, value in interrupts:
        assert svd.interrupts[name + "_IRQ"] == int(value), name
