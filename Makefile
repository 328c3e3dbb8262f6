# Short names for the presets and scripts; everything works without make.
.DEFAULT_GOAL := help
.PHONY: help deps build test asan tsan format lint bench demo check clean

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 16
deps:  ## install what is missing with apt
	scripts/install-deps
build:  ## configure and build the release preset
	cmake --preset release && cmake --build --preset release
test:  ## configure, build and test the dev preset (asserts on)
	cmake --workflow --preset dev
asan:  ## the same with the address and undefined-behaviour sanitizers
	cmake --workflow --preset asan
tsan:  ## the concurrent tests with the thread sanitizer
	cmake --workflow --preset tsan
format:  ## format all C++ files in place
	scripts/format
lint: build  ## clang-tidy and shellcheck
	scripts/lint build/release
bench: build  ## the benchmarks, on small data
	scripts/bench build/release
demo:  ## index a generated place and ask where a partial cloud was taken
	./demo
check:  ## everything CI checks
	./check
clean:  ## remove all that was built
	rm -rf build out
