"""Small programs for the tests of the numbers of the cores, compiled as the library is."""
import subprocess

COMPILE = {
    "cortex-m0": ["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m0"],
    "cortex-m4": ["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m4"],
    "rv32": ["riscv64-unknown-elf-gcc", "-march=rv32imac", "-mabi=ilp32"],
}

# What keeps a function a function, and a frame on the stack.
PRELUDE = """
#define KEEP __attribute__((noipa))
KEEP void use(volatile char *bytes) { *bytes = 1; }
"""


def make_variant(folder, sources, variant="cortex-m4"):
    """Objects, call graphs and the image `whole` of {object: source} as the Makefile makes them."""
    compile_, place, objects = COMPILE[variant], folder / variant, []
    for name, source in sources.items():
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.with_suffix(".c").write_text(PRELUDE * (name == "src/balancer/robot.o") + source)
        subprocess.run([*compile_, "-std=gnu11", "-g", "-O1", "-w", "-ffunction-sections", "-fdata-sections",
                        "-fcallgraph-info=su", "-c", path.with_suffix(".c"), "-o", path], check=True)
        objects.append(path)
    subprocess.run([*compile_, "-nostartfiles", "-nostdlib", "-Wl,--entry=0", *objects, "-lgcc", "-o", place / "whole"],
                   check=True, stderr=subprocess.DEVNULL)
    return place
