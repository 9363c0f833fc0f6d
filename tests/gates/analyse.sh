#!/usr/bin/env bash
# Clang's static analyser finds nothing on any path through the library, the HAL and the simulator. `make analyse`.
checks='-*,clang-analyzer-*,-clang-analyzer-security.insecureAPI.DeprecatedOrUnsafeBufferHandling' \
    exec bash "$(dirname "$0")/tidy.sh"
