#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "hmd_sim/trace_info.hpp"
#include "hmd_sim/trace_io.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

using Json = nlohmann::ordered_json;

Json repairs_json(const sim::TraceRepairs& repairs) {
  return {{"poses_read", repairs.poses_read},
          {"poses_kept", repairs.poses_kept},
          {"dropped_non_finite", repairs.dropped_non_finite},
          {"dropped_bad_quaternion", repairs.dropped_bad_quaternion},
          {"dropped_time", repairs.dropped_time},
          {"renormalised", repairs.renormalised},
          {"sign_flips", repairs.sign_flips},
          {"gaps", repairs.gaps},
          {"gaze_read", repairs.gaze_read},
          {"gaze_lost", repairs.gaze_lost},
          {"gaze_bad", repairs.gaze_bad}};
}

/// null without gaze.
Json gaze_json(const sim::TraceInfo& info) {
  if (!info.has_gaze) return nullptr;
  return {{"lost", info.gaze_lost},
          {"blinks", info.blinks},
          {"speed_deg_s",
           {{"mean", info.gaze_speed_deg_s_mean},
            {"p95", info.gaze_speed_deg_s_p95},
            {"max", info.gaze_speed_deg_s_max}}},
          {"off_axis_deg", {{"mean", info.gaze_off_deg_mean}, {"max", info.gaze_off_deg_max}}}};
}

void print_gaze(const sim::TraceInfo& info) {
  if (!info.has_gaze) {
    fmt::print("  gaze           none\n");
    return;
  }
  fmt::print(
      "  gaze           {:.1f} / {:.1f} deg off straight ahead (mean / max), {:.1f} / {:.1f} / {:.1f} deg/s "
      "(mean / p95 / max), lost in {} readings of {} blinks\n",
      info.gaze_off_deg_mean, info.gaze_off_deg_max, info.gaze_speed_deg_s_mean, info.gaze_speed_deg_s_p95,
      info.gaze_speed_deg_s_max, info.gaze_lost, info.blinks);
}

Json info_json(const sim::TraceReadResult& read, const sim::TraceInfo& info) {
  return {
      {"name", read.trace.name()},
      {"format", sim::to_string(read.format)},
      {"poses", info.poses},
      {"duration_s", info.duration_s},
      {"rate_hz", info.rate_hz},
      {"interval_ms",
       {{"min", info.interval_ms_min}, {"median", info.interval_ms_median}, {"max", info.interval_ms_max}}},
      {"gaps", info.gaps},
      {"duplicates", info.duplicates},
      {"angular_speed_deg_s",
       {{"mean", info.angular_speed_deg_s_mean},
        {"p95", info.angular_speed_deg_s_p95},
        {"p99", info.angular_speed_deg_s_p99},
        {"max", info.angular_speed_deg_s_max}}},
      {"linear_speed_m_s",
       {{"mean", info.linear_speed_m_s_mean},
        {"p95", info.linear_speed_m_s_p95},
        {"p99", info.linear_speed_m_s_p99},
        {"max", info.linear_speed_m_s_max}}},
      {"extent_m",
       {info.position_max_m.x - info.position_min_m.x, info.position_max_m.y - info.position_min_m.y,
        info.position_max_m.z - info.position_min_m.z}},
      {"gaze", gaze_json(info)},
      {"repairs", repairs_json(read.repairs)}};
}

sim::TraceFormat format_for(const TraceConvertCommand& command) {
  if (!command.format.empty()) return sim::parse_trace_format(command.format);
  const std::string extension = command.to.extension().string();
  if (extension == ".trace") return sim::TraceFormat::brace;
  if (extension == ".txt") return sim::TraceFormat::tum;
  if (extension == ".csv") return sim::TraceFormat::euroc;
  throw input_error("{}: which form? accepted: the extensions .trace, .txt (TUM), .csv (EuRoC), or --format",
                    command.to.string());
}

}  // namespace

int trace_info_command(const TraceInfoCommand& command) {
  const sim::TraceReadResult read = sim::read_trace(command.file, {.strict = command.strict});
  const sim::TraceInfo info = sim::trace_info(read.trace);
  if (command.json) {
    fmt::print("{}\n", info_json(read, info).dump(2));
    return 0;
  }
  fmt::print("{} ({} form)\n", read.trace.name(), sim::to_string(read.format));
  fmt::print("  poses          {} over {:.3f} s, {:.1f} Hz\n", info.poses, info.duration_s, info.rate_hz);
  fmt::print("  interval       {:.3f} / {:.3f} / {:.3f} ms (min / median / max), {} gaps above 50 ms\n",
             info.interval_ms_min, info.interval_ms_median, info.interval_ms_max, info.gaps);
  fmt::print("  turning        {:.1f} / {:.1f} / {:.1f} / {:.1f} deg/s (mean / p95 / p99 / max)\n",
             info.angular_speed_deg_s_mean, info.angular_speed_deg_s_p95, info.angular_speed_deg_s_p99,
             info.angular_speed_deg_s_max);
  fmt::print("  moving         {:.3f} / {:.3f} / {:.3f} / {:.3f} m/s (mean / p95 / p99 / max)\n",
             info.linear_speed_m_s_mean, info.linear_speed_m_s_p95, info.linear_speed_m_s_p99,
             info.linear_speed_m_s_max);
  fmt::print("  extent         {:.2f} x {:.2f} x {:.2f} m\n", info.position_max_m.x - info.position_min_m.x,
             info.position_max_m.y - info.position_min_m.y, info.position_max_m.z - info.position_min_m.z);
  print_gaze(info);
  fmt::print("  repeated poses {}\n", info.duplicates);
  fmt::print("  repairs        {}\n", sim::describe(read.repairs));
  return 0;
}

int trace_convert_command(const TraceConvertCommand& command) {
  const sim::TraceFormat format = format_for(command);
  const sim::TraceReadResult read = sim::read_trace(command.from);
  sim::write_trace(command.to, read.trace, format,
                   {fmt::format("converted from {} ({} form)", command.from.filename().string(),
                                sim::to_string(read.format)),
                    sim::describe(read.repairs)});
  fmt::print("{}: {} poses ({})\n", command.to.string(), read.trace.poses().size(),
             sim::describe(read.repairs));
  return 0;
}

int trace_generate_command(const TraceGenerateCommand& command) {
  if (!(command.rate_hz >= 20.0 && command.rate_hz <= 1e5)) {
    throw input_error("--rate {}: accepted: 20 to 100000 poses per second", command.rate_hz);
  }
  sim::MotionSpec spec;
  spec.motion = sim::parse_motion(command.motion == "still" ? "stationary" : command.motion);
  spec.degrees = command.degrees;
  spec.degrees_per_s = command.degrees;
  spec.metres = command.metres;
  spec.seconds = command.seconds;
  spec.seed = command.seed;
  spec.rate = {static_cast<std::int64_t>(command.rate_hz * 1000.0 + 0.5), 1000};
  spec.gaze = {sim::parse_eye_motion(command.gaze), command.blinks_per_minute, command.seed};
  if (spec.gaze.motion == sim::EyeMotion::none && command.blinks_per_minute > 0.0) {
    throw input_error("--blinks {} without gaze; accepted with it: --gaze saccades or pursuit",
                      command.blinks_per_minute);
  }
  const sim::PoseTrace trace = sim::generate_trace(spec);
  std::vector<std::string> notes = {
      fmt::format("generated: {} about the neck, {} degrees, {} m, {} s, {} Hz, seed {}", command.motion,
                  command.degrees, command.metres, command.seconds, command.rate_hz, command.seed)};
  if (trace.has_gaze())
    notes.push_back(fmt::format("gaze: {}, {} blinks per minute", command.gaze, command.blinks_per_minute));
  sim::write_trace(command.to, trace, sim::TraceFormat::brace, notes);
  fmt::print("{}: {} poses\n", command.to.string(), trace.poses().size());
  return 0;
}

}  // namespace brace
