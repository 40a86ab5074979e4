// A spring that moves, and the collisions of each frame: `spring FOLDER`, where `sscc demo --out FOLDER` has written the spring, its
// certificates and its motion. Prints one line of JSON for each frame, with the answers of
// `sscc check spring.model.safetensors --certificates spring.sscc.safetensors --trajectory spring.npy --json`.
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "sscc/sscc.hpp"

// The numbers of an .npy file of doubles, row by row.
static std::vector<double> read_npy(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.size() < 10 || bytes.compare(0, 7, "\x93NUMPY\x01") != 0) throw std::runtime_error(path + ": no .npy file");
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const std::size_t start = 10 + header;
  const std::string text = bytes.substr(10, header);
  if (text.find("'<f8'") == std::string::npos || text.find("'fortran_order': False") == std::string::npos ||
      start > bytes.size() || (bytes.size() - start) % sizeof(double) != 0) {
    throw std::runtime_error(path + ": not an array of doubles, row by row");
  }
  std::vector<double> numbers((bytes.size() - start) / sizeof(double));
  std::memcpy(numbers.data(), bytes.data() + start, numbers.size() * sizeof(double));
  return numbers;
}

static void print(std::size_t frame, sscc::view<const sscc::pair> pairs, const sscc::statistics& cost) {
  const char* const proofs[] = {"search", "radius", "local"};
  std::printf("{\"index\":%zu,\"colliding\":%s,\"count\":%zu,\"complete\":%s,\"pairs\":[", frame,
              pairs.empty() ? "false" : "true", pairs.size(), cost.complete ? "true" : "false");
  for (const sscc::pair& p : pairs) std::printf("%s[%u,%u]", &p == pairs.begin() ? "" : ",", p.a, p.b);
  std::printf("],\"root_certified\":%s,\"proof\":\"%s\"}\n", cost.proof == SSCC_PROOF_SEARCH ? "false" : "true",
              proofs[cost.proof]);
}

int main(int count, char** arguments) try {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s FOLDER    (that of `sscc demo --out FOLDER`)\n", arguments[0]);
    return 2;
  }
  const std::string folder = std::string(arguments[1]) + "/";
  const auto model = sscc::model::load(folder + "spring.model.safetensors");
  const auto certificates = sscc::certificates::load(folder + "spring.sscc.safetensors");
  const std::vector<double> motion = read_npy(folder + "spring.npy");
  auto query = sscc::query::make(model, certificates);
  for (std::size_t frame = 0; (frame + 1) * model.rank() <= motion.size(); ++frame) {
    const sscc::view<const double> q(motion.data() + frame * model.rank(), model.rank());
    const auto pairs = query.discrete(q);
    print(frame, pairs, query.cost());
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 2;
}
