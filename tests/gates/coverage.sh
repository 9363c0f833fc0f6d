#!/usr/bin/env bash
# The host tests execute every line and take every branch of src/. Arguments: test programs whose library counts that.
# The last lines are a table. With PAGES=yes build/coverage/index.html shows each line.
. "$(dirname "$0")/gate.sh"

: "${JP_BUILD:?is set by the Makefile}"
report=$JP_BUILD/coverage
export report

# Lines and branches are taken by a few cases, but for two of the planner; without optimisation many cases are slow.
run() {
    case $1 in
    */prop_cell_costs) "$1" --count 60 ;;
    */prop_far_sweep) "$1" --count 25 ;;
    */prop_lattice_way) "$1" --count 100 ;;
    */prop_planner) "$1" --count 1000 --seed 5 ;;
    */prop_planner_memory) "$1" --count 60 ;;
    */prop_pose_field) "$1" --count 40 ;;
    */prop_scan_match) "$1" --count 1 ;;
    */prop_waypoints) "$1" --count 10 ;;
    *) "$1" ;;
    esac
}

no_problem_in() {
    ! grep -F "$1:" "$report/problems"
}
export -f run no_problem_in

measure() {
    local pages=()
    [ "${PAGES:-}" != yes ] || pages=(--html-details "$report/index.html")
    "${PYTHON:-python3}" -m gcovr --root . --object-directory "$JP_BUILD/host-coverage" --filter src/ \
        --json-summary "$report/summary.json" "${pages[@]}" "$JP_BUILD/host-coverage" &&
        "${PYTHON:-python3}" -m tools.measure.coverage_report "$report/summary.json" "$JP_BUILD/bench/coverage.json" \
            >"$report/table" 2>"$report/problems"
}

find "$JP_BUILD/host-coverage" -name '*.gcda' -delete
rm -rf "$report"
mkdir -p "$report" "$JP_BUILD/bench"
check_each run "$@"
mapfile -t files < <(find src -name '*.[ch]' | sort)
check gcovr measure
check_each no_problem_in "${files[@]}"
cat "$report/table"
echo "left out:"
grep -rnE 'GCOVR?_EXCL' src || echo "nothing"
finish
