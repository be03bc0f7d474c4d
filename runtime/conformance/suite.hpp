#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "runtime/conformance/conformance.hpp"
#include "runtime/host/allocation_count.hpp"

namespace brace {

// Inside runtime/conformance only.

/// A clause is broken; the message is the figure.
struct Broken : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Collects clauses. A check returns its figure, or throws Broken or brace::Error.
class Suite {
 public:
  explicit Suite(std::function<void(const ClauseResult&)> on_clause) : on_clause_(std::move(on_clause)) {}

  bool clause(const std::string& name, const std::function<std::string()>& check);
  /// Work that clauses after it judge: a result only where it fails, which a stage that has passed
  /// "lifecycle" does only if it fails now and then.
  void prepare(const std::string& name, const std::function<void()>& work);
  std::vector<ClauseResult> take() { return std::move(results_); }

 private:
  std::function<void(const ClauseResult&)> on_clause_;
  std::vector<ClauseResult> results_;
};

/// What one use of a stage gave.
struct Trial {
  std::vector<std::byte> outputs;
  std::uint64_t values = 0;       // rays, pixels, poses …
  std::string violation;          // of the kind's contract; "" if it is kept
  std::uint64_t allocations = 0;  // by the calls into a native stage
};

template <typename T>
void append(std::vector<std::byte>& to, const T* values, std::size_t count) {
  const auto* bytes = reinterpret_cast<const std::byte*>(values);
  to.insert(to.end(), bytes, bytes + count * sizeof(T));
}

/// What buffers hold before a stage writes them. The second is a valid value of every kind of output.
inline constexpr std::uint32_t first_fill = 0xffffffffu, second_fill = 0x2b2b2b2bu;

/// A stage on the bench. The calls follow the life of a stage; brace::Error when it fails.
class Subject {
 public:
  virtual ~Subject() = default;

  virtual void make(const std::vector<double>& values) = 0;
  virtual void activate() = 0;
  /// One use with ordinary input, the same every time.
  virtual Trial use() = 0;
  virtual void deactivate() = 0;
  virtual void unmake() = 0;

  /// False for kernels, where the host owns everything.
  virtual bool is_native() const = 0;
  /// True if what runs per frame runs on the host, so that its allocations can be told from the driver's.
  virtual bool runs_on_host() const = 0;

  /// The clauses of the kind; the stage is not made.
  virtual void own_clauses(Suite& suite, const std::vector<double>& values) = 0;

  /// Blocks of memory that calls into a native stage took and did not give back, so far.
  std::int64_t kept_blocks() const { return kept_blocks_; }

 protected:
  /// Runs a call into a native stage. The host's own work around it, such as recording, is not counted.
  template <typename Call>
  void counted(Call&& call, Trial* trial = nullptr) {
    const AllocationCount before = allocations_of_this_thread();
    try {
      call();
    } catch (...) {
      kept_blocks_ += allocations_of_this_thread().living() - before.living();
      throw;
    }
    const AllocationCount after = allocations_of_this_thread();
    kept_blocks_ += after.living() - before.living();
    if (trial != nullptr) trial->allocations += after.allocations - before.allocations;
  }

 private:
  std::int64_t kept_blocks_ = 0;
};

/// make … unmake around some calls.
class Life {
 public:
  Life(Subject& subject, const std::vector<double>& values) : subject_(subject) {
    subject_.make(values);
    try {
      subject_.activate();
    } catch (...) {
      subject_.unmake();
      throw;
    }
  }
  ~Life() {
    subject_.deactivate();
    subject_.unmake();
  }
  Life(const Life&) = delete;
  Life& operator=(const Life&) = delete;

 private:
  Subject& subject_;
};

/// The clauses of every kind. False if the stage does not live at all.
bool common_clauses(Suite& suite, Subject& subject, const StageInfo& stage,
                    const std::vector<double>& values);

std::unique_ptr<Subject> make_cast_subject(const StageInfo& stage, const CheckOptions& options);
std::unique_ptr<Subject> make_rays_subject(const StageInfo& stage, const CheckOptions& options);
std::unique_ptr<Subject> make_skip_subject(const StageInfo& stage, const CheckOptions& options);
std::unique_ptr<Subject> make_picture_subject(const StageInfo& stage, const CheckOptions& options);
std::unique_ptr<Subject> make_host_subject(const StageInfo& stage);

}  // namespace brace
