// Calls the library from C++17 with exceptions: answers, views, callables that throw, threads. Prints "passed".
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sscc/sscc.hpp"

#define CHECK(condition)                                                      \
  do {                                                                        \
    if (!(condition)) {                                                       \
      std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);    \
      std::exit(1);                                                           \
    }                                                                         \
  } while (0)

namespace {

// The status that a call throws.
template <class F>
sscc::status refused(F&& call) {
  try {
    call();
  } catch (const sscc::error& e) {
    CHECK(e.what()[0] != '\0');
    return e.code();
  }
  return SSCC_STATUS_OK;
}

// The exception of a callable of the test.
struct stopped : std::runtime_error {
  stopped() : std::runtime_error("stopped") {}
};

template <class F>
bool is_stopped(F&& call) {
  try {
    call();
  } catch (const stopped&) {
    return true;
  }
  return false;
}

// A strip of triangles that its mode folds onto itself.
struct strip {
  std::vector<double> rest, modes;
  std::vector<std::uint32_t> faces;

  explicit strip(std::uint32_t n) {
    for (std::uint32_t i = 0; i < 2 * n + 2; ++i) {
      const double along = i / 2;
      rest.insert(rest.end(), {along, double(i % 2), 0.1 * (i / 2 % 3)});
      modes.insert(modes.end(), {along * along / n / n, 0.0, 0.0});
    }
    for (std::uint32_t i = 0; i < 2 * n; ++i) faces.insert(faces.end(), {i, i + 1, i + 2});
  }
};

}  // namespace

int main() {
  const std::vector<double> rest = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  const std::array<std::uint32_t, 6> faces = {0, 1, 2, 3, 4, 5};
  const double mode[18] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, -1, 0, 0, -1};
  const auto model = sscc::model::make(sscc::positions(rest), sscc::faces(faces), sscc::rows({mode, 18}, 1));
  CHECK(model.rank() == 1 && model.vertex_count() == 6 && model.triangle_count() == 2);
  CHECK(model.faces() == std::vector<std::uint32_t>(faces.begin(), faces.end()));

  // Progress: a callable without a value, one that returns true, one that throws.
  std::size_t reports = 0;
  auto certificates = sscc::certificates::compute(model, {}, [&](std::size_t, std::size_t) { ++reports; });
  CHECK(reports > 0 && certificates.root_radius() > 0.5);
  CHECK(refused([&] {
          sscc::certificates::compute(model, {}, [](std::size_t, std::size_t) { return true; });
        }) == SSCC_STATUS_CANCELLED);
  CHECK(is_stopped([&] {
    sscc::certificates::compute(model, {}, [](std::size_t, std::size_t) { throw stopped(); });
  }));
  CHECK(is_stopped([&] {
    const auto cancel = []() -> bool { throw stopped(); };
    sscc::certificates::compute(model, {}, [](std::size_t, std::size_t) {}, cancel);
  }));
  CHECK(is_stopped([&] {
    sscc::certify_options options;
    options.threads = 2;
    sscc::certificates::compute(model, options, [](std::size_t, std::size_t) -> bool { throw stopped(); });
  }));

  auto query = sscc::query::make(model, certificates);
  const std::vector<double> q0 = {0.0}, q1 = {1.0}, q2 = {2.0};
  CHECK(query.discrete(q0).empty() && query.cost().proof == SSCC_PROOF_RADIUS);
  const auto pairs = query.discrete(q1);
  CHECK(pairs.size() == 1 && pairs[0].a == 0 && pairs[0].b == 1);
  CHECK(query.discrete(q1, 0).empty() && query.cost().complete == 0);
  CHECK(query.first(q1).size() == 1 && query.first(q2).empty());
  CHECK(query.continuous(q0, q2).size() == 1 && std::abs(query.impacts()[0].time - 0.5) < 1e-9);
  CHECK(query.pairs().size() == 1);
  const double scale = query.safe_scale(q2);
  CHECK(scale > 0.4 && scale <= 0.5);
  std::size_t visited = 0;
  query.discrete(q1);
  query.visit_pairs([&](sscc::pair p) { visited += p.a + p.b; });
  CHECK(visited == 1);
  CHECK(is_stopped([&] { query.visit_pairs([](sscc::pair) { throw stopped(); }); }));
  CHECK(refused([&] { query.visit_pairs([](sscc::pair) { return true; }); }) == SSCC_STATUS_CANCELLED);
  CHECK(refused([&] { query.visit_pairs([&](sscc::pair) { query.discrete(q1); }); }) == SSCC_STATUS_BUSY);
  // The query can be used after the exception.
  CHECK(query.discrete(q1).size() == 1);

  // Errors.
  CHECK(refused([&] { query.discrete(rest); }) == SSCC_STATUS_ARGUMENT);
  CHECK(refused([&] { query.continuous(q0, rest); }) == SSCC_STATUS_ARGUMENT);
  CHECK(query.discrete(q0).empty());
  CHECK(refused([&] { sscc::model::load("no such file.obj"); }) == SSCC_STATUS_FILE);
  CHECK(refused([&] { sscc::certificates::load("no such file.safetensors"); }) == SSCC_STATUS_FILE);
  const std::vector<double> seven(7);
  CHECK(refused([&] { sscc::detector::make(sscc::positions(seven), sscc::faces(faces)); }) == SSCC_STATUS_ARGUMENT);
  const std::vector<double> three(3);
  const std::array<std::uint32_t, 3> one_face = {0, 0, 0};
  for (const std::size_t columns : {std::size_t{0}, std::size_t{2}, std::size_t{4}}) {
    const auto incomplete = sscc::rows(three, columns);
    CHECK(refused([&] { sscc::detector::make(incomplete, sscc::faces(one_face)); }) == SSCC_STATUS_ARGUMENT);
    CHECK(refused([&] { sscc::model::make(sscc::positions(rest), sscc::faces(faces), incomplete); }) ==
          SSCC_STATUS_ARGUMENT);
  }
  const sscc::query moved = std::move(query);
  CHECK(refused([&] { query.discrete(q0); }) == SSCC_STATUS_NULL);
  auto kinetic = sscc::kinetic::make(model, certificates);
  int touching = 0;
  for (int step = 0; step < 32; ++step) {
    const std::array<double, 1> q = {step / 16.0};
    touching += int(kinetic.discrete(q).size());
  }
  CHECK(touching == 1 && kinetic.continuous(q0, q2).size() == 1);

  // Detectors and shapes.
  auto detector = sscc::detector::make(sscc::positions(rest), sscc::faces(faces));
  const auto flat = model.positions(q1), passed = model.positions(q2);
  CHECK(detector.discrete(sscc::positions(flat)).size() == 1 && detector.first(sscc::positions(rest)).empty());
  CHECK(detector.continuous(sscc::positions(rest), sscc::positions(passed)).size() == 1);
  auto other = detector.clone();
  CHECK(detector.against(sscc::positions(rest), other, sscc::positions(rest)).size() == 2);
  CHECK(refused([&] { detector.against(sscc::positions(rest), detector, sscc::positions(rest)); }) ==
        SSCC_STATUS_OVERLAP);
  auto shape = sscc::shape::make(model, certificates);
  auto second = sscc::shape::make(model);
  const auto bounds = second.place(q0, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 1}});
  CHECK(bounds.upper[2] > 1.9 && shape.against(second).size() == 1 && shape.pairs()[0].a == 1);
  shape.place(q0, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
  CHECK(shape.pairs().empty());

  // Callables that cancel queries, and that throw.
  const strip folded(200);
  const auto large = sscc::model::make(sscc::positions(folded.rest), sscc::faces(folded.faces),
                                       sscc::rows(folded.modes, 1));
  auto certified = sscc::query::make(large, sscc::certificates::compute(large));
  const std::array<double, 1> q = {-200.0};
  const std::size_t wanted = certified.discrete(q).size();
  CHECK(wanted > 20);
  certified.cancel_when([] { return true; });
  CHECK(refused([&] { certified.discrete(q); }) == SSCC_STATUS_CANCELLED && certified.pairs().empty());
  // After an exception of a callable there is no older answer.
  certified.never_cancel();
  CHECK(certified.discrete(q).size() == wanted);
  // An empty callable is none.
  certified.cancel_when([] { return true; });
  certified.cancel_when(nullptr);
  CHECK(certified.discrete(q).size() == wanted);
  certified.cancel_when([] { return true; });
  certified.cancel_when(std::function<bool()>());
  CHECK(certified.discrete(q).size() == wanted);
  certified.cancel_when([]() -> bool { throw stopped(); });
  CHECK(is_stopped([&] { certified.discrete(q); }) && certified.pairs().empty());
  certified.never_cancel();
  const std::array<double, 1> q_t0 = {0.0};
  CHECK(!certified.continuous(q_t0, q).empty() && !certified.impacts().empty());
  certified.cancel_when([]() -> bool { throw stopped(); });
  CHECK(is_stopped([&] { certified.continuous(q_t0, q); }));
  CHECK(certified.pairs().empty() && certified.impacts().empty());
  auto moved_query = std::move(certified);
  CHECK(is_stopped([&] { moved_query.discrete(q); }));
  CHECK(moved_query.clone().discrete(q).size() == wanted);
  moved_query.never_cancel();
  CHECK(moved_query.discrete(q).size() == wanted);

  // 32 threads, each with a copy.
  std::atomic<int> equal{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 32; ++i) {
    threads.emplace_back([&, copy = moved_query.clone()]() mutable { equal += copy.discrete(q).size() == wanted; });
  }
  for (auto& thread : threads) thread.join();
  CHECK(equal == 32);
  std::puts("passed");
}
