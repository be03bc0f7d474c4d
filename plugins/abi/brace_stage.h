/* The public C interface of Brace's stages. Plain C11, also valid C++20; depends on nothing but <stdint.h>.
 *
 * Rules that hold everywhere here:
 *  - A struct that starts with struct_size (bytes, set by whoever fills it) only ever grows at its end: read
 * a field only if struct_size covers it. Structs without struct_size are frozen.
 *  - No function throws, longjmps, aborts or ends the process across this interface; failure is a return
 * value.
 *  - Unless a function says otherwise it is called on the host's frame thread, never concurrently for one
 *    stage object, and the host keeps ownership of every pointer it passes (valid for that call only).
 *  - Units are SI and stand in the names; times are int64 nanoseconds on the simulated clock; frames follow
 *    OpenXR (right-handed, +X right, +Y up, -Z forward). Quaternions are unit, ordered x, y, z, w.
 *
 * The life of a stage object, and the states that the comments name:
 *
 *   create ──► created ──activate──► active ──record, execute, update, predict…──► active (any number of
 * times) ▲                     │ └─────deactivate──────┘          destroy only in created, exactly once
 *
 *  create and activate may allocate, read files and wait. What runs once per frame (open, close, record,
 *  execute, update, predict, cost) never waits for the device, never allocates and never touches files.
 */
#ifndef BRACE_STAGE_H
#define BRACE_STAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRACE_ABI_VERSION_MAJOR 1
#define BRACE_ABI_VERSION_MINOR 2
/* A version as one number, for the ranges that host and library exchange. */
#define BRACE_ABI_VERSION_MAKE(major, minor) (((uint32_t)(major) << 16) | (uint32_t)(minor))
#define BRACE_ABI_VERSION BRACE_ABI_VERSION_MAKE(BRACE_ABI_VERSION_MAJOR, BRACE_ABI_VERSION_MINOR)

#if defined(__GNUC__)
#define BRACE_EXPORT __attribute__((visibility("default")))
#else
#define BRACE_EXPORT
#endif

/* Vulkan handles, as <vulkan/vulkan.h> declares them on 64-bit platforms. */
struct VkInstance_T;
struct VkPhysicalDevice_T;
struct VkDevice_T;
struct VkCommandBuffer_T;
struct VkBuffer_T;
struct VkBufferView_T;
struct VkImageView_T;
struct VkSampler_T;

typedef enum brace_result {
  BRACE_OK = 0,
  BRACE_ERROR = 1,           /* the stage failed; see last_error */
  BRACE_UNSUPPORTED = 2,     /* the stage cannot serve this configuration */
  BRACE_INVALID_ARGUMENT = 3 /* the host broke the contract */
} brace_result;

typedef struct brace_pose {   /* frozen */
  double orientation_xyzw[4]; /* unit quaternion: rotates head-frame vectors into the world */
  double position_m[3];
} brace_pose;

/* One tracker reading as a predictor sees it. Velocities are finite differences of the tracker's own
 * readings: angular in the head frame, linear in the world frame. Frozen. */
typedef struct brace_tracker_sample {
  int64_t time_ns;
  brace_pose world_from_head;
  double angular_velocity_rad_s[3];
  double linear_velocity_m_s[3];
} brace_tracker_sample;

/* A parameter of a stage: shown by `brace list stages`, checked in sessions before the stage sees it. */
typedef enum brace_param_type {
  BRACE_PARAM_BOOL = 0,
  BRACE_PARAM_INT = 1,
  BRACE_PARAM_FLOAT = 2,
  BRACE_PARAM_CHOICE = 3 /* the value is the index into choices */
} brace_param_type;

typedef struct brace_param {
  uint32_t struct_size; /* also the distance to the next one of an array */
  const char* name;     /* snake_case, unit last: bias_factor, reserve_ms */
  uint32_t type;        /* brace_param_type */
  const char* unit;     /* "" if none */
  const char* help;     /* one line */
  double minimum, maximum, default_value;
  const char* const* choices; /* null-terminated; null unless CHOICE */
} brace_param;

typedef enum brace_kind {
  BRACE_KIND_RAYS = 1,
  BRACE_KIND_CAST = 2,
  BRACE_KIND_SKIP = 3,
  BRACE_KIND_STEREO = 4,
  BRACE_KIND_SCHEDULE = 5, /* compiled into the host only: there is no table of functions for it */
  BRACE_KIND_WARP = 6,
  BRACE_KIND_CONTROL = 7,
  BRACE_KIND_PREDICT = 8,
  BRACE_KIND_COST = 9
} brace_kind;

/* ---- Memory ---------------------------------------------------------------------------------------------
 */

/* A range of a buffer. The stage touches nothing outside it. Frozen. */
typedef struct brace_buffer_range {
  struct VkBuffer_T* buffer; /* null where the host executes without a device */
  uint64_t offset_bytes;     /* within buffer */
  uint64_t size_bytes;
  void* mapped; /* the range's first byte as the host sees it; null if it is not mapped */
} brace_buffer_range;

/* How the voxels lie on the device; brace/volume.glsl reads all of them. */
typedef enum brace_volume_layout {
  BRACE_VOLUME_LAYOUT_IMAGE = 0,     /* 3D image with linear sampler; normalised integers */
  BRACE_VOLUME_LAYOUT_PACKED_8 = 1,  /* R32_UINT texel buffer, 2 x 2 voxels per texel, apron of edge voxels */
  BRACE_VOLUME_LAYOUT_PACKED_16 = 2, /* R32_UINT texel buffer, 2 voxels along x per texel, apron */
  BRACE_VOLUME_LAYOUT_TEXELS_32 = 3  /* R32_SFLOAT texel buffer, apron */
} brace_volume_layout;

typedef enum brace_voxel_type {
  BRACE_VOXEL_UINT8 = 0,
  BRACE_VOXEL_INT16 = 1,
  BRACE_VOXEL_UINT16 = 2,
  BRACE_VOXEL_FLOAT32 = 3
} brace_voxel_type;

/* The volume. The box is [0, dims] in voxel coordinates; voxel (i, j, k) is a cell with its value at
 * (i, j, k) + 0.5, trilinear in between, and beyond the outermost centres the values are those of the edge.
 */
typedef struct brace_volume {
  uint32_t struct_size;
  uint32_t dims[3]; /* x, y, z */
  brace_voxel_type type;
  double spacing[3];                /* relative: one unit of length is the smallest of them */
  double metres_per_unit;           /* of the scene */
  brace_pose world_from_volume;     /* of the box's centre; the axes are the voxel axes */
  double value_scale, value_offset; /* value in the data's own units = voxel * value_scale + value_offset */

  /* Reads the slices z_begin … z_begin + z_count - 1 into `voxels`: host byte order, x fastest, then y, then
   * z, size_bytes exactly. Thread: frame thread. State: only inside activate. Slices in ascending order are
   * cheap; going back reads from the start again. Returns BRACE_INVALID_ARGUMENT for slices that are not
   * there or another size, BRACE_ERROR when the data cannot be read (the host then ends the run with its own
   * message). `voxels` belongs to the stage. */
  brace_result (*read_slices)(const struct brace_volume* volume, uint32_t z_begin, uint32_t z_count,
                              void* voxels, uint64_t size_bytes);
  void* host_context; /* the host's own */

  /* On the device; null in stages that execute on the host. Valid from activate until deactivate. */
  brace_volume_layout layout;
  struct VkBufferView_T* texels; /* the packed layouts */
  struct VkImageView_T* image;   /* BRACE_VOLUME_LAYOUT_IMAGE, in VK_IMAGE_LAYOUT_GENERAL, with sampler */
  struct VkSampler_T* sampler;
} brace_volume;

/* The transfer function as a table of n entries:
 *   u = clamp((v - minimum) / (maximum - minimum), 0, 1) * (n - 1),  i = min(floor(u), n - 2),  f = u - i,
 *   r, g, b, kappa = (1 - f) * entry[i] + f * entry[i + 1], each by itself; NaN is empty. */
typedef struct brace_transfer_table {
  uint32_t struct_size;
  uint32_t entry_count;       /* 256 … 4096 */
  double minimum, maximum;    /* values of the first and the last entry, in the data's own units */
  const double* entries_rgbk; /* 4 * entry_count: colour not premultiplied; absorption per unit of length */
} brace_transfer_table;

/* What a stage that uses the device works with. Everything belongs to the host and lives until deactivate. */
typedef struct brace_vulkan {
  uint32_t struct_size;
  uint32_t api_version; /* of the device, as VK_MAKE_API_VERSION */
  struct VkInstance_T* instance;
  struct VkPhysicalDevice_T* physical_device;
  struct VkDevice_T* device;
  uint32_t queue_family_index; /* compute; all commands are recorded for it */
  /* vkGetInstanceProcAddr. The only way to Vulkan: a stage links to no loader. Thread: any. */
  void (*(*get_instance_proc_addr)(struct VkInstance_T* instance, const char* name))(void);
} brace_vulkan;

typedef enum brace_format {
  BRACE_FORMAT_NONE = 0,
  BRACE_FORMAT_RGBA8_PREMULTIPLIED = 1, /* a uint per pixel, r in the lowest byte; rows top to bottom */
  BRACE_FORMAT_R32_FLOAT = 2, /* metres from the eye to the first visible sample, +infinity if none */
  BRACE_FORMAT_RGBA32_FLOAT = 3
} brace_format;

/* How visible samples are lit: the session's scene.shading. */
typedef enum brace_shading {
  BRACE_SHADING_NONE = 0,
  BRACE_SHADING_PHONG = 1,     /* these three: brace/shade.glsl; directions: brace/light_directions.h */
  BRACE_SHADING_SHADOW_AO = 2, /* 24 samples towards a light, 14 around */
  BRACE_SHADING_RANDOM_LIGHTS = 3
} brace_shading;

/* ---- Activation -----------------------------------------------------------------------------------------
 */

/* Sizes, formats and data of everything that follows until deactivate. A pointer in it stays valid until
 * deactivate unless it says otherwise. Kinds control, predict and cost get it with null and 0 throughout. */
typedef struct brace_activation {
  uint32_t struct_size;
  const brace_vulkan* vulkan;           /* null for kinds without a device: control, predict, cost */
  uint32_t eye_width_px, eye_height_px; /* of one eye's picture; 0 if there is none */
  brace_format eye_image_format, eye_depth_format;
  uint32_t ray_count_max; /* rays of one eye; buffers are at least this large */
  const brace_volume* volume;
  const brace_transfer_table* transfer;
  double step_units;     /* the step that the device's transfer table has baked in, in units of length */
  brace_shading shading; /* since 1.1, like all that follow */
  /* Of shadings that take additional samples: how many (random_lights: 0 to 64); from one to the next, in
   * units of length; towards the light of shadow_ao, of length 1 in the volume's metric axes. */
  uint32_t shading_samples;
  double shading_step_units;
  double shading_light[3];
} brace_activation;

/* ---- Kinds: what happens once per frame -----------------------------------------------------------------
 */

/* One eye's view. Frozen. */
typedef struct brace_eye_view {
  brace_pose world_from_eye;                       /* eye frame: +X right, +Y up, -Z forward */
  double tan_left, tan_right, tan_bottom, tan_top; /* signed tangents at the image's edges */
  uint32_t width_px, height_px;
} brace_eye_view;

typedef struct brace_work_counts { /* frozen */
  uint64_t rays, samples, skip_steps, shading_fetches, texels, bytes;
} brace_work_counts;

/* A rectangle of the ray grid, or of the eye image in the closing brace. Frozen. */
typedef struct brace_area {
  uint32_t x, y, width, height;
} brace_area;

/* What the skip stage binds for the cast, as brace/skip_grid.glsl lays it out: 32-bit words. */
typedef enum brace_skip_map {
  BRACE_SKIP_MAP_NONE = 0,      /* nothing is skipped */
  BRACE_SKIP_MAP_DISTANCES = 1, /* brace/skip_distance.glsl: a byte per block, four to a word */
  BRACE_SKIP_MAP_BITS = 2,      /* skip/block: a bit per block, set where something is visible */
  BRACE_SKIP_MAP_OCTREE = 3     /* skip/octree: a bit-field per node */
} brace_skip_map;

#include "brace_segments.h"
/* One eye of one eye frame between the braces. The layouts are those of brace/ray_buffers.glsl and
 * brace/eye_params.h:
 *   params            BraceEyeParams (160 bytes)
 *   ray_entries       4 floats per ray: entry point in voxel coordinates; length in units, <= 0: no ray
 *   ray_directions    4 floats per ray: voxels per unit of length along each axis; level of detail
 *   result_colours    4 floats per ray: premultiplied, 0 <= r, g, b <= a <= 1
 *   result_depths_m   1 float per ray: metres from the eye to the first visible sample, +infinity if none
 *   eye_image         1 uint per pixel (BRACE_FORMAT_RGBA8_PREMULTIPLIED)
 *   eye_depth_m       1 float per pixel
 *   transfer          4096 * 4 floats: r, g, b, optical depth of one step in powers of two
 *   skip_words        32-bit words of the skip stage's map; null where there is none
 *   skip_params       BraceSkipParams (brace/skip_params.h)
 *   counters          64 rows of 8 uints: low and high word of rays, samples, skip steps, shading fetches;
 *                     a stage adds what it knows of (atomically), or leaves them alone
 * Ray (x, y) has the index y * rays_across + x; the same holds for pixels and width_px. */
typedef struct brace_cast_frame {
  uint32_t struct_size;
  uint32_t eye; /* 0 left, 1 right */
  uint64_t frame;
  struct VkCommandBuffer_T* commands; /* null in execute */
  brace_eye_view view;
  uint32_t rays_across, rays_down;
  brace_area area; /* what to work on; rays, or pixels in close */
  brace_buffer_range params;
  brace_buffer_range ray_entries, ray_directions;
  brace_buffer_range result_colours, result_depths_m;
  brace_buffer_range eye_image, eye_depth_m;
  brace_buffer_range transfer;
  brace_buffer_range counters;
  brace_work_counts* counted; /* execute only, else null: the stage adds its work here */
  brace_skip_map skip_map;    /* since 1.1: what skip_words holds */
  brace_buffer_range skip_words, skip_params;
  const brace_segment_sink* segments; /* since 1.2, execute only: null unless segments are asked for */
} brace_cast_frame;

/* Rules of everything that records (open, close, record):
 *  Thread: frame thread. State: active; `commands` is in the recording state, outside a render pass, for the
 *  queue family of the activation. What was recorded before is visible to the stage's commands, and the host
 *  puts a full barrier behind them; between its own commands the stage puts its barriers itself. The host
 *  submits and waits. The stage neither begins, ends, resets, submits nor keeps `commands`, never waits and
 *  never allocates. Its pipelines and descriptor pools are made in activate and stay alive until deactivate,
 *  which comes only after the device has finished. Any bound state may be left changed. */

/* rays: the opening and the closing brace, one object. */
typedef struct brace_rays_functions {
  uint32_t struct_size;
  /* Writes ray_entries and ray_directions of every ray of frame->area. Rules of recording above. */
  brace_result (*open)(void* self, const brace_cast_frame* frame);
  /* Reads result_colours and result_depths_m, writes eye_image and eye_depth_m of every pixel of frame->area.
   * Rules of recording above. */
  brace_result (*close)(void* self, const brace_cast_frame* frame);
} brace_rays_functions;

/* cast: rays in, colour and first-hit depth out. Exactly one of the two is not null. */
typedef struct brace_cast_functions {
  uint32_t struct_size;
  /* Writes result_colours and result_depths_m of every ray of frame->area. Rules of recording above. */
  brace_result (*record)(void* self, const brace_cast_frame* frame);
  /* The same on the host: every range that the stage needs is mapped, `commands` is null, the device is idle.
   * Thread: frame thread; the stage may use threads of its own that it joins or parks before it returns.
   * State: active. Does not allocate, but for segments that frame->segments asks for. */
  brace_result (*execute)(void* self, const brace_cast_frame* frame);
  uint32_t gives_segments; /* since 1.2; not 0: execute tells frame->segments of what it integrates */
} brace_cast_functions;

/* skip: a distance map over blocks of voxels, which the public hook brace/skip_distance.glsl reads. A byte
 * per block, that of block (x, y, z) at z * slice_bytes + y * row_bytes + x: the Chebyshev distance in blocks
 * to the nearest occupied block, clamped to 255; 0: the block is occupied. Smaller is safe, larger is not. A
 * block is occupied unless every sample in it and up to half a voxel beyond its faces, trilinear
 * interpolation included, is fully transparent. */
typedef struct brace_skip_frame {
  uint32_t struct_size;
  uint32_t block_edge_voxels;
  struct VkCommandBuffer_T* commands; /* null in execute_update */
  uint32_t blocks[3];                 /* ceil(dims / block_edge_voxels) */
  uint32_t row_bytes;                 /* a multiple of 4, at least blocks[0] */
  uint64_t slice_bytes;
  brace_buffer_range distances;         /* slice_bytes * blocks[2] bytes */
  const brace_transfer_table* transfer; /* the one to build the map for; valid for this call */
} brace_skip_frame;

/* Exactly one of the two updates is not null. Called after activate and after every change of the transfer
 * function, before the next cast. */
typedef struct brace_skip_functions {
  uint32_t struct_size;
  /* The edge of a block in voxels, 1 … 64, the same until deactivate. Frame thread; active. */
  uint32_t (*block_edge_voxels)(void* self);
  /* Rules of recording above. */
  brace_result (*record_update)(void* self, const brace_skip_frame* frame);
  /* On the host: distances is mapped. Frame thread; active; may take time, does not allocate. */
  brace_result (*execute_update)(void* self, const brace_skip_frame* frame);
} brace_skip_functions;

/* stereo: the right eye's frame from the left one's. */
typedef struct brace_stereo_frame {
  uint32_t struct_size;
  uint64_t frame;
  struct VkCommandBuffer_T* commands;
  brace_eye_view left, right;
  brace_buffer_range left_params, right_params;  /* BraceEyeParams */
  brace_buffer_range left_image, left_depth_m;   /* finished */
  brace_buffer_range right_image, right_depth_m; /* to be written, every pixel */
} brace_stereo_frame;

typedef struct brace_stereo_functions {
  uint32_t struct_size;
  /* Rules of recording above. */
  brace_result (*record)(void* self, const brace_stereo_frame* frame);
} brace_stereo_functions;

/* warp: an eye frame, re-projected to a newer pose, at the eye frame's size. */
typedef struct brace_warp_frame {
  uint32_t struct_size;
  uint32_t eye;        /* 0 left, 1 right */
  uint64_t frame;      /* the eye frame that is shown */
  int64_t vsync_index; /* the vsync it is warped for */
  struct VkCommandBuffer_T* commands;
  brace_eye_view rendered;                   /* the eye frame's view */
  brace_pose world_from_eye;                 /* where the eye will be; the FOV is that of `rendered` */
  brace_buffer_range eye_image, eye_depth_m; /* in */
  brace_buffer_range warped_image;           /* out, every pixel; BRACE_FORMAT_RGBA8_PREMULTIPLIED */
} brace_warp_frame;

typedef struct brace_warp_functions {
  uint32_t struct_size;
  /* Rules of recording above. */
  brace_result (*record)(void* self, const brace_warp_frame* frame);
} brace_warp_functions;

/* predict: head pose at a future time from what the tracker has reported so far. */
typedef struct brace_predict_functions {
  uint32_t struct_size;
  /* history: `count` >= 1 samples, oldest first, times strictly increasing; consecutive calls overlap.
   * target_ns may lie before the newest sample. The result is finite, its quaternion unit.
   * Frame thread; active. Must not allocate. */
  brace_result (*predict)(void* self, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                          brace_pose* world_from_head);
} brace_predict_functions;

/* control: follows the load. Called once per finished eye frame. */
typedef struct brace_control_input {
  uint32_t struct_size;
  uint64_t frame;
  int64_t frame_cost_ns; /* device time of the frame's ray casting */
  int64_t budget_ns;     /* device time available per display period */
  uint32_t missed;       /* vsyncs missed since the last call */
  uint32_t delay_frames; /* frames between a decision and its effect */
} brace_control_input;

typedef struct brace_control_functions {
  uint32_t struct_size;
  /* quality: 0 < quality <= 1, the fraction of the full ray count asked of the next frame.
   * Frame thread; active. Must not allocate. */
  brace_result (*update)(void* self, const brace_control_input* input, double* quality);
} brace_control_functions;

/* cost: the duration of a job on the simulated GPU from its counted work. */
typedef struct brace_cost_functions {
  uint32_t struct_size;
  /* job: "cast", "warp" or "update". duration_ns >= 0. Frame thread; active. Must not allocate. */
  brace_result (*cost)(void* self, const char* job, const brace_work_counts* work, int64_t* duration_ns);
} brace_cost_functions;

/* ---- A stage, and the library it comes in ---------------------------------------------------------------
 */

/* A stage: what it is and how to make one. Static data; lives as long as the library is loaded. */
typedef struct brace_stage_descriptor {
  uint32_t struct_size;
  uint32_t kind;       /* brace_kind; a plain number, as a library may know kinds that the host does not */
  const char* name;    /* without the family: "kalman" */
  const char* version; /* "1.2.0" */
  const char* help;    /* one line */
  const brace_param* params;
  uint32_t param_count;
  /* values: param_count numbers in the order of params, each within its range. Returns null on failure, else
   * an object in the state created, which the host destroys. Frame thread. */
  void* (*create)(const double* values, uint32_t count);
  /* Takes back ownership; never fails. Frame thread; created. */
  void (*destroy)(void* self);
  const void* functions; /* the kind's table: brace_predict_functions for BRACE_KIND_PREDICT, … */
  /* created → active, on BRACE_OK only. BRACE_UNSUPPORTED: this configuration cannot be served; last_error
   * says why. Frame thread. Null: nothing to do. */
  brace_result (*activate)(void* self, const brace_activation* activation);
  /* active → created; gives back everything that activate took; the device has finished with it. Never fails.
   * Frame thread. Null: nothing to do. */
  void (*deactivate)(void* self);
  /* What went wrong in the last call that returned another value than BRACE_OK: one line, owned by the stage,
   * valid until the next call on it. Frame thread; any state. Null, or a null result: nothing to say. */
  const char* (*last_error)(void* self);
} brace_stage_descriptor;

typedef enum brace_log_level {
  BRACE_LOG_INFO = 0,
  BRACE_LOG_WARNING = 1,
  BRACE_LOG_ERROR = 2
} brace_log_level;

/* What the host tells a library. Valid as long as the library is loaded. */
typedef struct brace_host {
  uint32_t struct_size;
  uint32_t abi_version_min, abi_version_max; /* BRACE_ABI_VERSION_MAKE; both inclusive */
  const char* name;                          /* "brace" */
  const char* version;                       /* "0.1.0" */
  void* context;                             /* the host's own, handed back to log */
  /* A line for the user. Thread: any. The host copies the message. */
  void (*log)(void* context, brace_log_level level, const char* message);
} brace_host;

/* What a library tells the host. The host zeroes it and sets struct_size to what it knows of; the library
 * writes no field beyond that. Strings and arrays are the library's, static. */
typedef struct brace_library {
  uint32_t struct_size;
  uint32_t abi_version_min, abi_version_max; /* always filled, also when they do not meet the host's */
  uint32_t abi_version;                      /* the newest version that both know; 0 if there is none */
  const char* name;
  const char* version;
  const brace_stage_descriptor* const* stages; /* stage_count pointers */
  uint32_t stage_count;
} brace_library;

/* The one symbol that a library exports. Called once, right after loading, on the thread that loads it.
 * Returns BRACE_UNSUPPORTED when the version ranges do not overlap, BRACE_ERROR when the library cannot work
 * here. */
#define BRACE_LIBRARY_ENTRY_NAME "brace_library_entry"
typedef brace_result (*brace_library_entry_function)(const brace_host* host, brace_library* library);
BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library);

/* The newest version in both ranges, 0 if they do not overlap: what a library writes to abi_version. */
static inline uint32_t brace_negotiate_abi(uint32_t a_min, uint32_t a_max, uint32_t b_min, uint32_t b_max) {
  const uint32_t newest = a_max < b_max ? a_max : b_max;
  const uint32_t oldest = a_min > b_min ? a_min : b_min;
  return newest >= oldest ? newest : 0u;
}

/* The entry of a library that was written for this header alone. */
static inline brace_result brace_fill_library(const brace_host* host, brace_library* library,
                                              const char* name, const char* version,
                                              const brace_stage_descriptor* const* stages,
                                              uint32_t stage_count) {
  library->abi_version_min = BRACE_ABI_VERSION_MAKE(BRACE_ABI_VERSION_MAJOR, 0);
  library->abi_version_max = BRACE_ABI_VERSION;
  library->name = name;
  library->version = version;
  library->abi_version = brace_negotiate_abi(host->abi_version_min, host->abi_version_max,
                                             library->abi_version_min, library->abi_version_max);
  if (library->abi_version == 0u) return BRACE_UNSUPPORTED;
  library->stages = stages;
  library->stage_count = stage_count;
  return BRACE_OK;
}

#ifdef __cplusplus
}
#endif

#endif
