"""SBPL motion primitives for the tests, made as its MATLAB scripts for a unicycle make them: short and long steps
ahead, a step back, an arc to each side, turns in place; 16 headings, ten poses with four decimals."""
import math

HEADINGS = 16
POSES = 10

# By heading within a quarter turn: end cell, change of heading, additionalactioncostmult.
MOTIONS = {
    0: [((1, 0), 0, 1), ((8, 0), 0, 1), ((-1, 0), 0, 5), ((8, 1), 1, 2), ((8, -1), -1, 2)],
    1: [((2, 1), 0, 1), ((6, 3), 0, 1), ((-2, -1), 0, 5), ((5, 4), 1, 2), ((7, 2), -1, 2)],
    2: [((1, 1), 0, 1), ((6, 6), 0, 1), ((-1, -1), 0, 5), ((5, 7), 1, 2), ((7, 5), -1, 2)],
}
MOTIONS[3] = [((y, x), -turn, factor) for (x, y), turn, factor in MOTIONS[1]]
TURNS = [((0, 0), 1, 5), ((0, 0), -1, 5)]


def quarters(cell, count):
    x, y = cell
    for _ in range(count):
        x, y = -y, x
    return x, y


def straight(start, end, turn):
    """Poses on a line, the heading turning evenly."""
    return [(end[0] * i / (POSES - 1), end[1] * i / (POSES - 1), start + turn * i / (POSES - 1)) for i in range(POSES)]


def arc(start, end, turn):
    """A line and then an arc of one radius, what misses the end spread along both."""
    stop = start + turn
    a, b = math.cos(start), math.sin(stop) - math.sin(start)
    c, d = math.sin(start), math.cos(start) - math.cos(stop)
    line = (end[0] * d - end[1] * b) / (a * d - b * c)
    radius = (a * end[1] - c * end[0]) / (a * d - b * c)
    rate, line = turn + line / radius, max(line, 0.0)
    poses = []
    for i in range(POSES):
        way = i / (POSES - 1) * radius * rate
        heading = start + max(0.0, way - line) / radius
        ahead = min(way, line)
        poses.append((ahead * math.cos(start) + radius * (math.sin(heading) - math.sin(start)),
                      ahead * math.sin(start) + radius * (math.cos(start) - math.cos(heading)), heading))
    miss = end[0] - poses[-1][0], end[1] - poses[-1][1]
    return [(x + miss[0] * i / (POSES - 1), y + miss[1] * i / (POSES - 1), heading)
            for i, (x, y, heading) in enumerate(poses)]


def motions(stretch=1):
    """(start, end cell, change of heading, factor); `stretch` makes the long ones longer."""
    for start in range(HEADINGS):
        for cell, turn, factor in MOTIONS[start % 4] + TURNS:
            if max(map(abs, cell)) > 2:
                cell = cell[0] * stretch, cell[1] * stretch
            yield start, quarters(cell, start // 4), turn, factor


def mprim_text(resolution, chosen=None):
    """A file of motions, without `chosen` all of them."""
    chosen = list(motions() if chosen is None else chosen)
    lines = [f"resolution_m: {resolution:.6f}", f"numberofangles: {HEADINGS}",
             f"totalnumberofprimitives: {len(chosen)}"]
    for index, (start, cell, turn, factor) in enumerate(chosen):
        angle, end = start * 2 * math.pi / HEADINGS, (cell[0] * resolution, cell[1] * resolution)
        make = straight if turn == 0 or cell == (0, 0) else arc
        lines += [f"primID: {index % 7}", f"startangle_c: {start}",
                  f"endpose_c: {cell[0]} {cell[1]} {(start + turn) % HEADINGS}", f"additionalactioncostmult: {factor}",
                  f"intermediateposes: {POSES}"]
        lines += [f"{x:.4f} {y:.4f} {heading:.4f}" for x, y, heading in make(angle, end, turn * 2 * math.pi / HEADINGS)]
    return "\n".join(lines) + "\n"
