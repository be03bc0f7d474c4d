#include "runtime/report/trace_events.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/report/output_file.hpp"

namespace brace {

namespace {

enum Track { vsync_track = 1, cast_track, warp_track, scan_out_track, pose_track, update_track };

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Nanoseconds as microseconds without a rounding: 1234567 -> "1234.567".
std::string us(std::int64_t ns) {
  const std::uint64_t magnitude =
      ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  return fmt::format("{}{}.{:03}", ns < 0 ? "-" : "", magnitude / 1000, magnitude % 1000);
}

class EventWriter {
 public:
  explicit EventWriter(OutputFile& file) : file_(file) { file_.write("{\"traceEvents\":[\n"); }

  void name_process(int process, const std::string& name) {
    add(fmt::format(R"({{"ph":"M","name":"process_name","pid":{},"args":{{"name":{}}}}})", process,
                    quoted(name)));
  }

  void name_track(int process, Track track, const char* name) {
    add(fmt::format(R"({{"ph":"M","name":"thread_name","pid":{},"tid":{},"args":{{"name":"{}"}}}})", process,
                    int{track}, name));
    add(fmt::format(R"({{"ph":"M","name":"thread_sort_index","pid":{},"tid":{},"args":{{"sort_index":{}}}}})",
                    process, int{track}, int{track}));
  }

  // `args` is JSON without its braces.
  void slice(int process, Track track, std::int64_t begin_ns, std::int64_t end_ns, const std::string& name,
             const std::string& args) {
    add(fmt::format(R"({{"ph":"X","pid":{},"tid":{},"ts":{},"dur":{},"name":{},"args":{{{}}}}})", process,
                    int{track}, us(begin_ns), us(end_ns - begin_ns), quoted(name), args));
  }

  void instant(int process, Track track, std::int64_t at_ns, const std::string& name,
               const std::string& args) {
    add(fmt::format(R"({{"ph":"i","s":"t","pid":{},"tid":{},"ts":{},"name":{},"args":{{{}}}}})", process,
                    int{track}, us(at_ns), quoted(name), args));
  }

  void flow(int process, std::int64_t id, Track from, std::int64_t from_ns, Track to, std::int64_t to_ns) {
    const auto end = [&](const char* phase, Track track, std::int64_t at_ns) {
      add(fmt::format(R"({{{},"cat":"frame","name":"shown","id":"{}.{}","pid":{},"tid":{},"ts":{}}})", phase,
                      process, id, process, int{track}, us(at_ns)));
    };
    end(R"("ph":"s")", from, from_ns);
    end(R"("ph":"f","bp":"e")", to, to_ns);
  }

  void finish(const std::string& other_data) {
    file_.write(fmt::format("\n],\"displayTimeUnit\":\"ms\",\"otherData\":{{{}}}}}\n", other_data));
  }

 private:
  void add(std::string_view event) {
    if (!first_) file_.write(",\n");
    first_ = false;
    file_.write(event);
  }

  OutputFile& file_;
  bool first_ = true;
};

std::string work_args(const WorkCounts& work) {
  return fmt::format(R"("rays":{},"samples":{},"skip_steps":{},"texels":{})", work.rays, work.samples,
                     work.skip_steps, work.texels);
}

Track track_of(JobKind kind) {
  return kind == JobKind::cast ? cast_track : kind == JobKind::warp ? warp_track : update_track;
}

void write_jobs(EventWriter& events, int process, std::span<const JobRecord> jobs, std::int64_t until_ns) {
  for (const JobRecord& job : jobs) {
    if (job.start_ns < 0 || job.end_ns < 0 || job.start_ns > until_ns) continue;
    const char* of = job.kind == JobKind::warp ? "vsync" : "frame";
    events.slice(process, track_of(job.kind), job.start_ns, job.end_ns, fmt::format("{} {}", of, job.index),
                 fmt::format(R"("{}":{},"job":{},"cost_ns":{},"preempted_ns":{},"waited_ns":{},{})", of,
                             job.index, job.job, job.cost_ns, job.preempted_ns, job.start_ns - job.submit_ns,
                             work_args(job.work)));
  }
}

// Without jobs the records tell of what was shown.
void write_record_slices(EventWriter& events, int process, const FrameRecord& record, bool frame_is_new) {
  if (frame_is_new && record.render_start_ns >= 0 && record.render_done_ns >= 0) {
    events.slice(process, cast_track, record.render_start_ns, record.render_done_ns,
                 fmt::format("frame {}", record.displayed_frame),
                 fmt::format(R"("frame":{},{})", record.displayed_frame, work_args(record.work)));
  }
  if (!record.missed && record.warp_start_ns >= 0 && record.warp_done_ns >= 0) {
    events.slice(process, warp_track, record.warp_start_ns, record.warp_done_ns,
                 fmt::format("vsync {}", record.vsync_index),
                 fmt::format(R"("vsync":{},"frame":{})", record.vsync_index, record.displayed_frame));
  }
}

void write_vsync(EventWriter& events, int process, const FrameRecord& record) {
  events.instant(process, vsync_track, record.vsync_ns, record.missed ? "missed vsync" : "vsync",
                 fmt::format(R"("vsync":{},"frame":{},"stale_run":{})", record.vsync_index,
                             record.displayed_frame, record.stale_run));
  if (record.photon_first_row_ns < 0 || record.photon_last_row_ns < 0) return;
  events.slice(process, scan_out_track, record.photon_first_row_ns, record.photon_last_row_ns,
               fmt::format("vsync {} shows frame {}", record.vsync_index, record.displayed_frame),
               fmt::format(R"("vsync":{},"frame":{},"missed":{},"photon_mid_us":{},"mtp_rotation_us":{})",
                           record.vsync_index, record.displayed_frame, record.missed,
                           us(record.photon_mid_ns), us(record.mtp_rotation_ns)));
}

void write_series(EventWriter& events, int process, const RunSeries& series, std::size_t vsyncs_max) {
  const auto records = series.records.first(std::min(vsyncs_max, series.records.size()));
  const bool all = records.size() == series.records.size();
  const std::int64_t until_ns =
      all || records.empty() ? std::numeric_limits<std::int64_t>::max() : records.back().vsync_ns;
  write_jobs(events, process, series.jobs, until_ns);
  FrameRecord before;
  for (const FrameRecord& record : records) {
    const bool frame_is_new = record.displayed_frame >= 0 && record.displayed_frame != before.displayed_frame;
    if (series.jobs.empty()) write_record_slices(events, process, record, frame_is_new);
    write_vsync(events, process, record);
    if (frame_is_new && record.render_start_ns >= 0 && record.photon_first_row_ns >= 0) {
      events.flow(process, record.vsync_index, cast_track, record.render_start_ns, scan_out_track,
                  record.photon_first_row_ns);
    }
    if (record.render_pose_ns >= 0 && record.render_pose_ns != before.render_pose_ns) {
      events.instant(process, pose_track, record.render_pose_ns, "render pose",
                     fmt::format(R"("frame":{})", record.displayed_frame));
    }
    if (record.warp_pose_ns >= 0 && record.warp_pose_ns != before.warp_pose_ns) {
      events.instant(process, pose_track, record.warp_pose_ns, "warp pose",
                     fmt::format(R"("vsync":{})", record.vsync_index));
    }
    before = record;
  }
}

}  // namespace

void write_trace_events(const std::filesystem::path& path, const ReportInput& input, std::size_t vsyncs_max) {
  OutputFile file(path);
  EventWriter events(file);
  std::string written;
  for (std::size_t i = 0; i < input.series.size(); ++i) {
    const RunSeries& series = input.series[i];
    const int process = static_cast<int>(i) + 1;
    events.name_process(process, series.label.empty() ? input.device : series.label);
    events.name_track(process, vsync_track, "vsync");
    events.name_track(process, cast_track, "ray casting");
    events.name_track(process, warp_track, "warp");
    events.name_track(process, scan_out_track, "scan-out");
    events.name_track(process, pose_track, "tracker poses");
    const auto is_update = [](const JobRecord& job) { return job.kind == JobKind::update; };
    if (std::any_of(series.jobs.begin(), series.jobs.end(), is_update)) {
      events.name_track(process, update_track, "updates");
    }
    write_series(events, process, series, vsyncs_max);
    written += fmt::format(R"({}"vsyncs {}":"{} of {}")", i == 0 ? "" : ",", process,
                           std::min(vsyncs_max, series.records.size()), series.records.size());
  }
  events.finish(written);
  file.close();
}

}  // namespace brace
