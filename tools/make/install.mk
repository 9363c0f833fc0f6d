# The library for programs on this machine, and the source package.

PREFIX  ?= /usr/local
DESTDIR ?=
VERSION  = $(shell sed -n 's/^\#define JP_VERSION_[A-Z]* *//p' include/joulepath/version.h | paste -sd.)

PREFIX_CHECK  = $(if $(filter /%,$(PREFIX)),,$(error PREFIX=$(PREFIX): must be an absolute path))
INSTALL_ROOT  = $(DESTDIR)$(PREFIX)
PACKAGES      = joulepath joulepath-float
# The programs and tools, as the Python package has them but without its module of C.
DOOR          = $(INSTALL_ROOT)/lib/joulepath
PACKAGE_FILES = $(INSTALL_ROOT)/include/joulepath $(INSTALL_ROOT)/lib/libjoulepath.a $(INSTALL_ROOT)/lib/libjoulepath_float.a \
                $(PACKAGES:%=$(INSTALL_ROOT)/lib/pkgconfig/%.pc) $(INSTALL_ROOT)/lib/cmake/joulepath $(INSTALL_ROOT)/share/doc/joulepath \
                $(DOOR) $(INSTALL_ROOT)/bin/joulepath

.PHONY: install
install: $(BUILD)/release/libjoulepath.a $(BUILD)/release/libjoulepath_float.a install-programs ## install the library, the programs and the command joulepath on this machine (PREFIX=/usr/local DESTDIR=)
	$(PREFIX_CHECK)
	install -d $(INSTALL_ROOT)/include/joulepath $(INSTALL_ROOT)/lib/pkgconfig $(INSTALL_ROOT)/lib/cmake/joulepath \
	    $(INSTALL_ROOT)/share/doc/joulepath
	install -m 644 include/joulepath/*.h $(INSTALL_ROOT)/include/joulepath
	install -m 644 $(filter %.a,$^) $(INSTALL_ROOT)/lib
	strip --strip-debug $(addprefix $(INSTALL_ROOT)/lib/,$(notdir $(filter %.a,$^)))
	set -e; for package in $(PACKAGES); do \
	    sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' tools/packaging/$$package.pc.in | \
	    install -m 644 /dev/stdin $(INSTALL_ROOT)/lib/pkgconfig/$$package.pc; done
	install -m 644 tools/packaging/joulepathConfig.cmake $(INSTALL_ROOT)/lib/cmake/joulepath
	sed 's|@VERSION@|$(VERSION)|' tools/packaging/joulepathConfigVersion.cmake.in | \
	    install -m 644 /dev/stdin $(INSTALL_ROOT)/lib/cmake/joulepath/joulepathConfigVersion.cmake
	install -m 644 LICENSE $(INSTALL_ROOT)/share/doc/joulepath

.PHONY: install-programs
install-programs: $(PROGRAMS)
	$(PREFIX_CHECK)
	umask 022 && tools/python/copy_tools.sh $(DOOR)/joulepath
	install -d $(DOOR)/joulepath/build/bin $(INSTALL_ROOT)/bin
	install -s -m 755 $(PROGRAMS) $(DOOR)/joulepath/build/bin
	install -m 644 tools/python/joulepath/door.py $(DOOR)/joulepath
	printf '#!/bin/sh\nexec python3 %s "$$@"\n' $(PREFIX)/lib/joulepath/joulepath/door.py | install -m 755 /dev/stdin $(INSTALL_ROOT)/bin/joulepath

.PHONY: uninstall
uninstall: ## remove what `make install` put there
	$(PREFIX_CHECK)
	rm -rf $(PACKAGE_FILES)

.PHONY: package
package: ## make the source package for CMake, Zephyr, PlatformIO and others in build/package
	tools/packaging/package.sh $(VERSION) $(BUILD)/package
