#include "runtime/timeline/event_queue.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace brace {
namespace {

enum class Kind { a, b };

TEST(EventQueue, EventsComeOutByTimeThenInsertion) {
  std::mt19937_64 random(7);
  EventQueue<Kind> queue(8);
  struct Pushed {
    std::int64_t time_ns, data;
  };
  std::vector<Pushed> pushed;
  for (std::int64_t i = 0; i < 2000; ++i) {
    const auto time_ns = static_cast<std::int64_t>(random() % 50);  // many ties
    queue.push(sim_time(time_ns), i % 2 == 0 ? Kind::a : Kind::b, i);
    pushed.push_back({time_ns, i});
  }
  std::stable_sort(pushed.begin(), pushed.end(),
                   [](const Pushed& a, const Pushed& b) { return a.time_ns < b.time_ns; });
  for (const Pushed& expected : pushed) {
    const Event<Kind> event = queue.pop();
    ASSERT_EQ(to_ns(event.time), expected.time_ns);
    ASSERT_EQ(event.data, expected.data);
    ASSERT_EQ(event.kind, expected.data % 2 == 0 ? Kind::a : Kind::b);
    ASSERT_EQ(queue.now(), event.time);
  }
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.processed(), 2000U);
}

TEST(EventQueue, AnEventPushedForNowComesAfterThoseAlreadyWaitingForNow) {
  EventQueue<Kind> queue;
  queue.push(sim_time(5), Kind::a, 1);
  queue.push(sim_time(5), Kind::a, 2);
  EXPECT_EQ(queue.pop().data, 1);
  queue.push(sim_time(5), Kind::a, 3);
  EXPECT_EQ(queue.pop().data, 2);
  EXPECT_EQ(queue.pop().data, 3);
}

TEST(EventQueueDeathTest, ThePastCannotBeScheduled) {
  EventQueue<Kind> queue;
  queue.push(sim_time(5), Kind::a);
  queue.pop();
  EXPECT_DEATH(queue.push(sim_time(4), Kind::a), "time >= last_");
}

}  // namespace
}  // namespace brace
