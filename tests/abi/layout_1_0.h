/* The layout of ABI 1.0 on 64-bit platforms. These numbers never change: a struct grows at its end only,
 * which leaves every offset here as it is and can only raise a size. ABI_SAME: frozen structs. */
#ifndef LAYOUT_1_0_H
#define LAYOUT_1_0_H

#include <stddef.h>

#include "brace_stage.h"
#include "eye_params.h"

#ifdef __cplusplus
#define ABI_ASSERT(condition) static_assert(condition, #condition)
#else
#define ABI_ASSERT(condition) _Static_assert(condition, #condition)
#endif
#define ABI_AT(type, field, offset) ABI_ASSERT(offsetof(type, field) == (offset))
#define ABI_LEAST(type, size) ABI_ASSERT(sizeof(type) >= (size))
#define ABI_SAME(type, size) ABI_ASSERT(sizeof(type) == (size))

ABI_SAME(brace_pose, 56);
ABI_SAME(brace_tracker_sample, 112);
ABI_SAME(brace_work_counts, 48);
ABI_SAME(brace_buffer_range, 32);
ABI_SAME(brace_eye_view, 96);
ABI_SAME(brace_area, 16);

ABI_LEAST(brace_param, 72);
ABI_AT(brace_param, struct_size, 0);
ABI_AT(brace_param, name, 8);
ABI_AT(brace_param, type, 16);
ABI_AT(brace_param, unit, 24);
ABI_AT(brace_param, minimum, 40);
ABI_AT(brace_param, default_value, 56);
ABI_AT(brace_param, choices, 64);

ABI_LEAST(brace_stage_descriptor, 96);
ABI_AT(brace_stage_descriptor, kind, 4);
ABI_AT(brace_stage_descriptor, name, 8);
ABI_AT(brace_stage_descriptor, params, 32);
ABI_AT(brace_stage_descriptor, param_count, 40);
ABI_AT(brace_stage_descriptor, create, 48);
ABI_AT(brace_stage_descriptor, destroy, 56);
ABI_AT(brace_stage_descriptor, functions, 64);
ABI_AT(brace_stage_descriptor, activate, 72);
ABI_AT(brace_stage_descriptor, deactivate, 80);
ABI_AT(brace_stage_descriptor, last_error, 88);

ABI_LEAST(brace_host, 48);
ABI_AT(brace_host, abi_version_min, 4);
ABI_AT(brace_host, abi_version_max, 8);
ABI_AT(brace_host, context, 32);
ABI_AT(brace_host, log, 40);

ABI_LEAST(brace_library, 48);
ABI_AT(brace_library, abi_version, 12);
ABI_AT(brace_library, stages, 32);
ABI_AT(brace_library, stage_count, 40);

ABI_LEAST(brace_vulkan, 48);
ABI_AT(brace_vulkan, instance, 8);
ABI_AT(brace_vulkan, device, 24);
ABI_AT(brace_vulkan, get_instance_proc_addr, 40);

ABI_LEAST(brace_volume, 176);
ABI_AT(brace_volume, dims, 4);
ABI_AT(brace_volume, spacing, 24);
ABI_AT(brace_volume, world_from_volume, 56);
ABI_AT(brace_volume, value_scale, 112);
ABI_AT(brace_volume, read_slices, 128);
ABI_AT(brace_volume, layout, 144);
ABI_AT(brace_volume, sampler, 168);

ABI_LEAST(brace_transfer_table, 32);
ABI_AT(brace_transfer_table, entries_rgbk, 24);

ABI_LEAST(brace_activation, 64);
ABI_AT(brace_activation, vulkan, 8);
ABI_AT(brace_activation, eye_image_format, 24);
ABI_AT(brace_activation, ray_count_max, 32);
ABI_AT(brace_activation, volume, 40);
ABI_AT(brace_activation, step_units, 56);

ABI_LEAST(brace_cast_frame, 440);
ABI_AT(brace_cast_frame, eye, 4);
ABI_AT(brace_cast_frame, commands, 16);
ABI_AT(brace_cast_frame, view, 24);
ABI_AT(brace_cast_frame, rays_across, 120);
ABI_AT(brace_cast_frame, area, 128);
ABI_AT(brace_cast_frame, params, 144);
ABI_AT(brace_cast_frame, counters, 400);
ABI_AT(brace_cast_frame, counted, 432);

ABI_LEAST(brace_skip_frame, 80);
ABI_AT(brace_skip_frame, commands, 8);
ABI_AT(brace_skip_frame, blocks, 16);
ABI_AT(brace_skip_frame, slice_bytes, 32);
ABI_AT(brace_skip_frame, distances, 40);

ABI_LEAST(brace_stereo_frame, 408);
ABI_AT(brace_stereo_frame, left, 24);
ABI_AT(brace_stereo_frame, right_depth_m, 376);

ABI_LEAST(brace_warp_frame, 280);
ABI_AT(brace_warp_frame, vsync_index, 16);
ABI_AT(brace_warp_frame, rendered, 32);
ABI_AT(brace_warp_frame, warped_image, 248);

ABI_LEAST(brace_rays_functions, 24);
ABI_LEAST(brace_cast_functions, 24);
ABI_LEAST(brace_skip_functions, 32);
ABI_LEAST(brace_stereo_functions, 16);
ABI_LEAST(brace_warp_functions, 16);
ABI_LEAST(brace_predict_functions, 16);
ABI_LEAST(brace_control_functions, 16);
ABI_LEAST(brace_cost_functions, 16);
ABI_LEAST(brace_control_input, 40);
ABI_AT(brace_control_input, frame_cost_ns, 16);
ABI_AT(brace_control_input, delay_frames, 36);

#endif
