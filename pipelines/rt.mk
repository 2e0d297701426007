# Recipes of the tools for GNU Make. Include this file and say what is made of what:
#
#   hall.rtmesh                                           made of hall.gltf, hall.obj, hall.scene.json, ...
#   hall.rtmesh: RT_MODELS = a/b.obj c.ply                or of these
#   hall.rtatlas: hall.rtmesh                             an atlas of a mesh
#   view.exr: hall.rtatlas                                view.exr and view.png; view.0012.exr is frame 12
#   query.hits: hall.rtatlas sun.rays                     what rt-trace --rays finds for these rays
#   view.passed: view.exr goldens/view.exr                two pictures compared; made anew each time that they are compared and agree, so
#                                                         that what is made of it is too. Make removes all of the folder before it makes
#                                                         anything: there are those that its last run came to and that agreed
#   fine.rtatlas: RT_GRID_FLAGS = --quality best          options, of one file or, without "fine.rtatlas:", of all
#
# FILE.json holds the figures of each step. Every step is called each time, and does nothing where its inputs, options and tool
# are those of its output, by content, whatever the time stamps say. With make -j pictures are rendered side by side, one on each of RT_DEVICES (with commas
# between them) at a time.
RT_TOOLS_DIR ?=
RT_DEVICES ?= auto
RT_MODELS ?=
RT_IMPORT_FLAGS ?=
RT_GRID_FLAGS ?=
RT_TRACE_FLAGS ?=
RT_QUERY_FLAGS ?=
RT_COMPARE_FLAGS ?=

rt_comma := ,
rt_bin = $(if $(RT_TOOLS_DIR),$(RT_TOOLS_DIR:%/=%)/)
rt_common = --json $@.json --if-changed
# The prerequisites of a kind; there must be some.
rt_inputs = $(or $(filter $(1),$^),$(error no $(1) is named as what $@ is made of))
# 0012 for NAME.0012.exr
rt_frame = $(shell expr "$(suffix $*)" : '[.]\([0-9][0-9]*\)$$')
rt_devices = $(or $(strip $(subst $(rt_comma), ,$(RT_DEVICES))),auto)
rt_device_option = $(if $(filter-out auto,$(rt_devices)),--device $(1))
rt_models = $(or $(RT_MODELS),$(filter-out .rt-always,$<),$(error $@: no model of its name, and no RT_MODELS))

.PHONY: .rt-always
.rt-always: # before all else; the name is none of a default goal
	@rm -f *.passed

define rt_import
$(rt_bin)rt-import $(rt_models) -o $@ $(rt_common) $(RT_IMPORT_FLAGS)
endef

$(foreach kind,scene.json obj ply stl gltf glb fbx 3ds dae off,$(eval %.rtmesh: %.$(kind) .rt-always; $$(rt_import)))
%.rtmesh: .rt-always
	$(rt_import)

%.rtatlas: .rt-always
	$(rt_bin)rt-grid $(call rt_inputs,%.rtmesh) -o $@ $(rt_common) $(RT_GRID_FLAGS)

# A frame's device follows from its number. A picture that is made of nothing, a golden say, is left as it is.
rt_trace = set -- $(rt_devices); i=$$(expr 0$(rt_frame) % $$\#); shift $$i; set -x; \
	flock .rt-device-$$i.lock $(rt_bin)rt-trace $(filter %.rtatlas,$^) -o $*.exr -o $*.png $(call rt_device_option,$$1) \
	$(addprefix --frames ,$(rt_frame)) --stats --reproducible $(rt_common) $(RT_TRACE_FLAGS)
rt_missing = echo "$@ is missing, and no %.rtatlas is named as what it is made of; if it is a golden: look at the new picture and copy \
	it there (update-goldens in the examples)" >&2; exit 1
rt_picture = $(if $(filter %.rtatlas,$^),$(rt_trace),[ -e '$@' ] || { $(rt_missing); })
%.exr: .rt-always
	@$(rt_picture)
# Made with the EXR of its name, where there is one.
%.png: %.exr
	@$(rt_picture)
%.png: .rt-always
	@$(rt_picture)

%.hits: .rt-always
	flock .rt-device-0.lock $(rt_bin)rt-trace $(call rt_inputs,%.rtatlas) --rays $(call rt_inputs,%.rays) -o $@ \
	$(call rt_device_option,$(firstword $(rt_devices))) $(rt_common) $(RT_QUERY_FLAGS)

%.passed: .rt-always
	@rm -f $@ # in other folders
	$(rt_bin)rt-compare $(call rt_inputs,%.exr) --json $*.json --html $*.html --if-changed $(RT_COMPARE_FLAGS)
	@touch $@
