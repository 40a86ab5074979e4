// Calls the library from C++17 without exceptions: every call returns a result. Prints "passed".
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "sscc/sscc.hpp"

#define CHECK(condition)                                                      \
  do {                                                                        \
    if (!(condition)) {                                                       \
      std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);    \
      std::exit(1);                                                           \
    }                                                                         \
  } while (0)

int main() {
  const std::array<double, 18> rest = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  const std::array<std::uint32_t, 6> faces = {0, 1, 2, 3, 4, 5};
  const std::array<double, 18> mode = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, -1, 0, 0, -1};
  auto model = sscc::model::make(sscc::positions(rest), sscc::faces(faces), sscc::rows(mode, 1));
  CHECK(model);
  auto cancelled = sscc::certificates::compute(model.value(), {}, [](std::size_t, std::size_t) { return true; });
  CHECK(!cancelled && cancelled.code() == SSCC_STATUS_CANCELLED);
  auto certificates = sscc::certificates::compute(model.value());
  CHECK(certificates);
  auto query = sscc::query::make(model.value(), certificates.value());
  CHECK(query);
  const std::array<double, 1> q = {1.0};
  auto pairs = query.value().discrete(q);
  CHECK(pairs && pairs.value().size() == 1);
  auto refused = query.value().discrete(rest);
  CHECK(!refused && refused.code() == SSCC_STATUS_ARGUMENT && refused.value().empty());
  CHECK(std::string(sscc_error_message()).find("q has 18 entries") != std::string::npos);
  CHECK(!query.value().continuous(q, rest));
  CHECK(query.value().cancel_when([] { return true; }));
  CHECK(query.value().cancel_when(nullptr));
  pairs = query.value().discrete(q);
  CHECK(pairs && pairs.value().size() == 1);
  CHECK(query.value().never_cancel());
  auto missing = sscc::model::load("no such file.obj");
  CHECK(missing.code() == SSCC_STATUS_FILE && missing.value().get() == nullptr);
  std::puts("passed");
}
