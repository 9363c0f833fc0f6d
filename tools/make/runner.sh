#!/usr/bin/env bash
# The program of a test file, as C: runner.sh TEST.c
# It calls every `static void test_…(void)` of the file in their order, by run_tests(), which a file with a main() of its own
# calls where it wants.
set -euo pipefail

test=$1

if grep -q 'RUN_TEST(' "$test"; then
    echo "#include \"$test\""
    exit
fi
echo 'static void run_tests(void);'
echo "#include \"$test\""
echo 'static void run_tests(void)'
echo '{'
awk -v file="$test" 'match($0, /^static void test_[A-Za-z0-9_]+\(void\)$/) {
    name = substr($0, 13, RLENGTH - 18)
    printf "#line %d \"%s\"\n    RUN_TEST(%s);\n", NR, file, name
}' "$test"
echo '}'
if ! grep -q '^int main(' "$test"; then
    printf 'int main(void)\n{\n#line 1 "%s"\n    UNITY_BEGIN();\n    run_tests();\n    return UNITY_END();\n}\n' "$test"
fi
