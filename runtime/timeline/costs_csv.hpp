#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "runtime/timeline/job_record.hpp"

namespace brace {

// costs.csv: a row per job in order of submission. Times are integer nanoseconds; a cell is empty where
// JobRecord has -1.

/// "job,kind,index,submit_ns,start_ns,end_ns,preempted_ns,cost_ns,rays,…\n"
std::string costs_csv_header();
void append_costs_csv_row(std::string& text, const JobRecord& record);

/// The whole file as text; equal records give equal bytes.
std::string to_costs_csv(std::span<const JobRecord> records);

/// Columns are found by name; unknown ones are ignored. Throws input_error naming file, line and column.
std::vector<JobRecord> read_costs_csv(const std::filesystem::path& path);

}  // namespace brace
