// sscc for C++17: the C interface (sscc.h) with owning classes, views of arrays, callables and exceptions. Header-only.
//
// A failed call throws sscc::error. With SSCC_NO_EXCEPTIONS, or if the compiler has exceptions off, every function that can
// fail returns sscc::result<T> instead, which contains the status. returns<T> is T or sscc::result<T>.
//
// Callables (progress, cancel, visit) may throw: the call ends, and throws the same exception. A callable that returns a value
// ends the call if the value is true.
//
// Views are valid until the next call with the same object. Threads and errors: as sscc.h states.
#ifndef SSCC_HPP
#define SSCC_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "sscc.h"

#if !defined(SSCC_NO_EXCEPTIONS) && !defined(__cpp_exceptions)
#define SSCC_NO_EXCEPTIONS
#endif

namespace sscc {

// Programs with and without exceptions have different types for the linker.
#ifdef SSCC_NO_EXCEPTIONS
inline namespace without_exceptions {
#else
inline namespace with_exceptions {
#endif

using status = sscc_status;
using pair = sscc_pair;
using impact = sscc_impact;
using statistics = sscc_statistics;
using box = sscc_box;
using pose = sscc_pose;
using matrix = sscc_matrix;
using index_matrix = sscc_index_matrix;

namespace detail {

// Whether a view accepts a container: its elements must be contiguous. Of the types of Eigen a view accepts only vectors without a
// stride; sscc::map is for matrices, in any order of storage.
template <class C, class = void>
struct is_contiguous : std::true_type {};
template <class C>
struct is_contiguous<C, std::void_t<decltype(C::IsVectorAtCompileTime), decltype(C::InnerStrideAtCompileTime)>>
    : std::bool_constant<bool(C::IsVectorAtCompileTime) && int(C::InnerStrideAtCompileTime) == 1> {};

}  // namespace detail

// A view of contiguous elements that another object owns, like std::span.
template <class T>
class view {
 public:
  constexpr view() noexcept = default;
  constexpr view(T* data, std::size_t size) noexcept : data_(data), size_(size) {}
  // Any container with data() and size(): std::vector, std::array, std::span, Eigen::VectorXd, a column of a column-major matrix.
  // A row of such a matrix is refused, because its elements are not contiguous, and so is a matrix: use map().
  template <class C, class P = decltype(std::declval<C&>().data()),
            class = std::enable_if_t<std::is_convertible_v<P, T*> && !std::is_same_v<std::decay_t<C>, view> &&
                                     detail::is_contiguous<std::decay_t<C>>::value>>
  constexpr view(C&& container) noexcept
      : data_(container.data()), size_(static_cast<std::size_t>(container.size())) {}

  constexpr T* data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr T* begin() const noexcept { return data_; }
  constexpr T* end() const noexcept { return data_ + size_; }
  constexpr T& operator[](std::size_t i) const noexcept { return data_[i]; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Returns numbers without gaps, row by row, as a matrix with that many columns. The library refuses the matrix if the last row
// is not complete, and if there are no columns.
inline matrix rows(view<const double> numbers, std::size_t columns) noexcept {
  if (columns == 0 || numbers.size() % columns != 0) {
    // Every function refuses a matrix larger than memory before it reads a number.
    return {numbers.data(), SIZE_MAX, SIZE_MAX, 0, 0};
  }
  return {numbers.data(), numbers.size() / columns, columns, 0, 0};
}

// Positions: x, y, z of each vertex, without gaps. Use map() for a matrix of Eigen.
inline matrix positions(view<const double> xyz) noexcept { return rows(xyz, 3); }

// Faces: three vertices for each triangle, without gaps. Use map() for a matrix of Eigen.
inline index_matrix faces(view<const std::uint32_t> vertices) noexcept {
  if (vertices.size() % 3 != 0) {
    return {vertices.data(), 1, vertices.size(), 0, 0};  // which the library refuses
  }
  return {vertices.data(), vertices.size() / 3, 3, 0, 0};
}

// Refers to a matrix, map or reference of Eigen without a copy, in any order of storage. The matrix must outlive the call.
template <class M>
auto map(const M& m) noexcept {
  using scalar = std::remove_cv_t<std::remove_pointer_t<decltype(m.data())>>;
  const auto size = [](auto number) { return static_cast<std::size_t>(number); };
  if constexpr (std::is_same_v<scalar, double>) {
    return matrix{m.data(), size(m.rows()), size(m.cols()), size(m.rowStride()), size(m.colStride())};
  } else {
    static_assert(std::is_integral_v<scalar> && sizeof(scalar) == 4, "double, or integers of 32 bits");
    // Negative numbers become too large, and are refused.
    const auto data = reinterpret_cast<const std::uint32_t*>(m.data());
    return index_matrix{data, size(m.rows()), size(m.cols()), size(m.rowStride()), size(m.colStride())};
  }
}

#ifdef SSCC_NO_EXCEPTIONS

// The outcome of a call, with its value if the status is SSCC_STATUS_OK.
template <class T>
class [[nodiscard]] result {
 public:
  result(status s, T value) : status_(s), value_(std::move(value)) {}
  explicit operator bool() const noexcept { return status_ == SSCC_STATUS_OK; }
  status code() const noexcept { return status_; }
  T& value() & noexcept { return value_; }
  T&& value() && noexcept { return std::move(value_); }

 private:
  status status_;
  T value_;
};

template <>
class [[nodiscard]] result<void> {
 public:
  explicit result(status s) : status_(s) {}
  explicit operator bool() const noexcept { return status_ == SSCC_STATUS_OK; }
  status code() const noexcept { return status_; }

 private:
  status status_;
};

template <class T>
using returns = result<T>;

#else

template <class T>
using returns = T;

#endif

// The exception of a failed call.
class error : public std::runtime_error {
 public:
  error(status s, const char* message) : std::runtime_error(message), status_(s) {}
  status code() const noexcept { return status_; }

 private:
  status status_;
};

namespace detail {

#ifdef SSCC_NO_EXCEPTIONS

inline result<void> finish(status s) { return result<void>(s); }

template <class T>
result<T> finish(status s, T value) {
  return {s, std::move(value)};
}

// sscc_error_message() does not have this message.
template <class T>
result<T> refuse(const char*) {
  return {SSCC_STATUS_ARGUMENT, T()};
}

#else

inline void finish(status s) {
  if (s != SSCC_STATUS_OK) throw error(s, sscc_error_message());
}

template <class T>
T finish(status s, T value) {
  finish(s);
  return value;
}

template <class T>
[[noreturn]] T refuse(const char* message) {
  throw error(SSCC_STATUS_ARGUMENT, message);
}

#endif

// Calls callables for C, and stores their exceptions until the call of the library has returned.
class catcher {
 public:
  template <class F, class... A>
  int call(F& f, A... arguments) noexcept {
#ifndef SSCC_NO_EXCEPTIONS
    try {
#endif
      if constexpr (std::is_void_v<std::invoke_result_t<F&, A...>>) {
        f(arguments...);
        return 0;
      } else {
        return f(arguments...) ? 1 : 0;
      }
#ifndef SSCC_NO_EXCEPTIONS
    } catch (...) {
      thrown_ = std::current_exception();
      return 1;
    }
#endif
  }

  void rethrow() {
#ifndef SSCC_NO_EXCEPTIONS
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
#endif
  }

 private:
#ifndef SSCC_NO_EXCEPTIONS
  std::exception_ptr thrown_;
#endif
};

struct freer {
  void operator()(sscc_model* handle) const noexcept { sscc_model_free(handle); }
  void operator()(sscc_certificates* handle) const noexcept { sscc_certificates_free(handle); }
  void operator()(sscc_query* handle) const noexcept { sscc_query_free(handle); }
  void operator()(sscc_kinetic* handle) const noexcept { sscc_kinetic_free(handle); }
  void operator()(sscc_detector* handle) const noexcept { sscc_detector_free(handle); }
  void operator()(sscc_shape* handle) const noexcept { sscc_shape_free(handle); }
};

template <class T>
using owner = std::unique_ptr<T, freer>;

// A callable that a handle checks for cancellation, at a fixed address.
struct canceller {
  std::function<bool()> ask;
  catcher caught;

  static int c_function(void* user) noexcept {
    auto& self = *static_cast<canceller*>(user);
    return self.caught.call(self.ask);
  }
};

// The base of objects with an answer. Api contains the functions of C for the handle.
template <class Api>
class answering {
 public:
  using handle_type = typename Api::handle;

  // The pairs of the last answer.
  view<const pair> pairs() const noexcept { return pairs_; }

  // Calls a callable with each pair of the last answer in the library's memory, in order. If it returns true, the visit ends
  // with SSCC_STATUS_CANCELLED.
  template <class F>
  returns<void> visit_pairs(F&& visit) const {
    using callable = std::remove_reference_t<F>;
    struct context {
      callable& visit;
      catcher caught;
    } both{visit, {}};
    const auto c_function = [](void* user, pair p) noexcept -> int {
      auto& c = *static_cast<context*>(user);
      return c.caught.call(c.visit, p);
    };
    const status s = Api::visit(handle_.get(), c_function, &both);
    both.caught.rethrow();
    return finish(s);
  }

  handle_type* get() const noexcept { return handle_.get(); }

 protected:
  answering() = default;
  explicit answering(handle_type* handle) : handle_(handle) {}

  returns<view<const pair>> answer(status s, std::size_t count) {
    pairs_.resize(s == SSCC_STATUS_OK ? count : 0);
    if (!pairs_.empty()) s = Api::pairs(handle_.get(), pairs_.data(), count);
    return finish(s, view<const pair>(pairs_));
  }

  owner<handle_type> handle_;
  std::vector<pair> pairs_;
};

// The base of objects that also have impacts, statistics and a callable that cancels.
template <class Api>
class searching : public answering<Api> {
 public:
  // The impacts of the last answer; a discrete answer has none.
  view<const impact> impacts() const noexcept { return impacts_; }

  // Returns the cost of the last answer, and the kind of its proof.
  returns<statistics> cost() const {
    statistics found{};
    const status s = Api::statistics(this->handle_.get(), &found);
    return finish(s, found);
  }

  // Sets a callable that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED. Copies have no callable.
  // Set it once, not for each answer: the call copies the state of the object. An empty callable, as std::function<bool()>() or
  // nullptr, is none: see never_cancel.
  returns<void> cancel_when(std::function<bool()> ask) {
    if (!ask) return never_cancel();
    auto next = std::make_unique<canceller>(canceller{std::move(ask), {}});
    const status s = Api::set_cancel(this->handle_.get(), canceller::c_function, next.get());
    if (s == SSCC_STATUS_OK) canceller_ = std::move(next);
    return finish(s);
  }

  // Removes the callable, so that later calls are not cancelled.
  returns<void> never_cancel() {
    const status s = Api::set_cancel(this->handle_.get(), nullptr, nullptr);
    if (s == SSCC_STATUS_OK) canceller_.reset();
    return finish(s);
  }

 protected:
  using answering<Api>::answering;

  returns<view<const pair>> discrete_answer(status s, std::size_t count) {
    forget();
    rethrow();
    return this->answer(s, count);
  }

  returns<view<const impact>> continuous_answer(status s, std::size_t count) {
    forget();
    rethrow();
    this->pairs_.resize(s == SSCC_STATUS_OK ? count : 0);
    impacts_.resize(this->pairs_.size());
    if (!impacts_.empty()) {
      s = Api::impacts(this->handle_.get(), impacts_.data(), count);
      for (std::size_t i = 0; i < count; ++i) this->pairs_[i] = {impacts_[i].a, impacts_[i].b};
    }
    return finish(s, view<const impact>(impacts_));
  }

  // Clears the last answer, also if the next call fails.
  void forget() noexcept {
    this->pairs_.clear();
    impacts_.clear();
  }

  void rethrow() {
    if (canceller_) canceller_->caught.rethrow();
  }

  std::vector<impact> impacts_;
  std::unique_ptr<canceller> canceller_;
};

// Creates an object from the handle that a function of C returns.
template <class Object, class Handle, class Make>
returns<Object> make(Make&& make) {
  Handle* handle = nullptr;
  const status s = make(&handle);
  return finish(s, Object(handle));
}

struct query_api {
  using handle = sscc_query;
  static constexpr auto pairs = sscc_query_pairs;
  static constexpr auto impacts = sscc_query_impacts;
  static constexpr auto visit = sscc_query_visit_pairs;
  static constexpr auto statistics = sscc_query_statistics;
  static constexpr auto set_cancel = sscc_query_set_cancel;
};

struct kinetic_api {
  using handle = sscc_kinetic;
  static constexpr auto pairs = sscc_kinetic_pairs;
  static constexpr auto impacts = sscc_kinetic_impacts;
  static constexpr auto visit = sscc_kinetic_visit_pairs;
  static constexpr auto statistics = sscc_kinetic_statistics;
  static constexpr auto set_cancel = sscc_kinetic_set_cancel;
};

struct detector_api {
  using handle = sscc_detector;
  static constexpr auto pairs = sscc_detector_pairs;
  static constexpr auto impacts = sscc_detector_impacts;
  static constexpr auto visit = sscc_detector_visit_pairs;
  static constexpr auto statistics = sscc_detector_statistics;
  static constexpr auto set_cancel = sscc_detector_set_cancel;
};

struct shape_api {
  using handle = sscc_shape;
  static constexpr auto pairs = sscc_shape_pairs;
  static constexpr auto visit = sscc_shape_visit_pairs;
};

}  // namespace detail

// The contact filter, with fields as in sscc.h.
struct filter : sscc_filter {
  filter() noexcept : sscc_filter{} { size = sizeof(sscc_filter); }
};

// Options of certificates, with fields as in sscc.h.
struct certify_options : sscc_certify_options {
  certify_options() noexcept : sscc_certify_options{} { size = sizeof(sscc_certify_options); }
};

// A mesh with its modes.
class model {
 public:
  model() = default;
  explicit model(sscc_model* handle) noexcept : handle_(handle) {}

  static returns<model> make(const matrix& positions, const index_matrix& faces, const matrix& modes) {
    return detail::make<model, sscc_model>([&](auto out) { return sscc_model_new(positions, faces, modes, out); });
  }

  static returns<model> load(const std::string& path) {
    return detail::make<model, sscc_model>([&](auto out) { return sscc_model_load(path.c_str(), nullptr, out); });
  }

  static returns<model> load(const std::string& mesh_path, const std::string& modes_path) {
    return detail::make<model, sscc_model>(
        [&](auto out) { return sscc_model_load(mesh_path.c_str(), modes_path.c_str(), out); });
  }

  returns<void> save(const std::string& path) const { return detail::finish(sscc_model_save(get(), path.c_str())); }

  std::size_t rank() const noexcept { return sscc_model_rank(get()); }
  std::size_t vertex_count() const noexcept { return sscc_model_vertex_count(get()); }
  std::size_t triangle_count() const noexcept { return sscc_model_triangle_count(get()); }

  // Returns three vertices for each triangle.
  returns<std::vector<std::uint32_t>> faces() const {
    std::vector<std::uint32_t> found(3 * triangle_count());
    const status s = sscc_model_faces(get(), found.data(), triangle_count());
    return detail::finish(s, std::move(found));
  }

  // Returns x, y, z of each vertex at q.
  returns<std::vector<double>> positions(view<const double> q) const {
    std::vector<double> found(3 * vertex_count());
    const status s = sscc_model_positions(get(), q.data(), q.size(), found.data(), vertex_count());
    return detail::finish(s, std::move(found));
  }

  sscc_model* get() const noexcept { return handle_.get(); }

 private:
  detail::owner<sscc_model> handle_;
};

// Certificates of a model.
class certificates {
 public:
  certificates() = default;
  explicit certificates(sscc_certificates* handle) noexcept : handle_(handle) {}

  static returns<certificates> compute(const model& m, const certify_options& options = {}) {
    return detail::make<certificates, sscc_certificates>([&](auto out) {
      return sscc_certificates_compute(m.get(), &options, nullptr, nullptr, nullptr, out);
    });
  }

  // Calls progress(done, total), which cancels if it throws or returns true. Threads of the library call it, one at a time.
  template <class Progress>
  static returns<certificates> compute(const model& m, const certify_options& options, Progress&& progress) {
    return compute(m, options, std::forward<Progress>(progress), [] { return false; });
  }

  // Calls progress(done, total), and cancel(), which is called often. Each cancels if it throws or returns true. Threads of the
  // library call them, one call at a time.
  template <class Progress, class Cancel>
  static returns<certificates> compute(const model& m, const certify_options& options, Progress&& progress,
                                       Cancel&& cancel) {
    using progress_type = std::remove_reference_t<Progress>;
    using cancel_type = std::remove_reference_t<Cancel>;
    struct context {
      progress_type& progress;
      cancel_type& cancel;
      detail::catcher caught;
    } all{progress, cancel, {}};
    const auto report = [](void* user, std::size_t done, std::size_t total) noexcept -> int {
      auto& c = *static_cast<context*>(user);
      return c.caught.call(c.progress, done, total);
    };
    const auto ask = [](void* user) noexcept -> int {
      auto& c = *static_cast<context*>(user);
      return c.caught.call(c.cancel);
    };
    sscc_certificates* handle = nullptr;
    const status s = sscc_certificates_compute(m.get(), &options, report, ask, &all, &handle);
    certificates computed(handle);
    all.caught.rethrow();
    return detail::finish(s, std::move(computed));
  }

  static returns<certificates> load(const std::string& path) {
    return detail::make<certificates, sscc_certificates>(
        [&](auto out) { return sscc_certificates_load(path.c_str(), out); });
  }

  returns<void> save(const std::string& path) const {
    return detail::finish(sscc_certificates_save(get(), path.c_str()));
  }

  double root_radius() const noexcept { return sscc_certificates_root_radius(get()); }
  std::size_t exception_count() const noexcept { return sscc_certificates_exception_count(get()); }

  sscc_certificates* get() const noexcept { return handle_.get(); }

 private:
  detail::owner<sscc_certificates> handle_;
};

// Finds the triangles of a model that collide at q, or between two q. One thread at a time may use it: clone() makes a copy for
// another thread.
class query : public detail::searching<detail::query_api> {
 public:
  query() = default;
  explicit query(sscc_query* handle) noexcept : searching(handle) {}

  static returns<query> make(const model& m, const certificates& c) {
    return detail::make<query, sscc_query>([&](auto out) { return sscc_query_new(m.get(), c.get(), out); });
  }

  // Returns a copy for another thread. It has no pairs() and no impacts() before its first answer.
  returns<query> clone() const {
    return detail::make<query, sscc_query>([&](auto out) { return sscc_query_clone(get(), out); });
  }

  // Returns all colliding pairs at q, or `limit` of them if there are more, sorted. If none are found and the limit is not 0, the
  // shape is proven free.
  returns<view<const pair>> discrete(view<const double> q,
                                     std::size_t limit = std::numeric_limits<std::size_t>::max()) {
    std::size_t count = 0;
    const status s = sscc_query_discrete_at_most(get(), q.data(), q.size(), limit, &count);
    return discrete_answer(s, count);
  }

  // Returns one colliding pair, or none.
  returns<view<const pair>> first(view<const double> q) {
    std::size_t count = 0;
    const status s = sscc_query_first(get(), q.data(), q.size(), nullptr, &count);
    return discrete_answer(s, count);
  }

  // Returns all pairs that collide between two q, sorted, with their times of impact.
  returns<view<const impact>> continuous(view<const double> q_t0, view<const double> q_t1) {
    if (q_t0.size() != q_t1.size()) return detail::refuse<view<const impact>>("q_t0 and q_t1 differ in length");
    std::size_t count = 0;
    const status s = sscc_query_continuous(get(), q_t0.data(), q_t1.data(), q_t0.size(), &count);
    return continuous_answer(s, count);
  }

  // Returns a scale s such that the shape is proven free at `center + t (q - center)` for all t in [0, s]. It can be larger than 1.
  // It is 0 if the shape collides at the centre, else infinite if q is the centre or the global radius is infinite.
  returns<double> safe_scale(view<const double> q) {
    double scale = 0.0;
    const status s = sscc_query_safe_scale(get(), q.data(), q.size(), &scale);
    forget();
    rethrow();
    return detail::finish(s, scale);
  }
};

// Finds the same pairs as query, faster for motions in small steps.
class kinetic : public detail::searching<detail::kinetic_api> {
 public:
  kinetic() = default;
  explicit kinetic(sscc_kinetic* handle) noexcept : searching(handle) {}

  static returns<kinetic> make(const model& m, const certificates& c) {
    return detail::make<kinetic, sscc_kinetic>([&](auto out) { return sscc_kinetic_new(m.get(), c.get(), out); });
  }

  // Returns a copy for another thread. It has no pairs() and no impacts() before its first answer.
  returns<kinetic> clone() const {
    return detail::make<kinetic, sscc_kinetic>([&](auto out) { return sscc_kinetic_clone(get(), out); });
  }

  // Returns all colliding pairs at q, sorted. If none are found, the shape is proven free.
  returns<view<const pair>> discrete(view<const double> q) {
    std::size_t count = 0;
    const status s = sscc_kinetic_discrete(get(), q.data(), q.size(), &count);
    return discrete_answer(s, count);
  }

  // Returns all pairs that collide between two q, sorted, with their times of impact.
  returns<view<const impact>> continuous(view<const double> q_t0, view<const double> q_t1) {
    if (q_t0.size() != q_t1.size()) return detail::refuse<view<const impact>>("q_t0 and q_t1 differ in length");
    std::size_t count = 0;
    const status s = sscc_kinetic_continuous(get(), q_t0.data(), q_t1.data(), q_t0.size(), &count);
    return continuous_answer(s, count);
  }
};

// Finds the triangles of any mesh that collide at given positions, during a motion between two positions, or with another mesh.
class detector : public detail::searching<detail::detector_api> {
 public:
  detector() = default;
  explicit detector(sscc_detector* handle) noexcept : searching(handle) {}

  static returns<detector> make(const matrix& rest, const index_matrix& faces, const filter& counted = {}) {
    return detail::make<detector, sscc_detector>(
        [&](auto out) { return sscc_detector_new(rest, faces, &counted, out); });
  }

  // Returns a copy for another thread. It has no pairs() and no impacts() before its first answer.
  returns<detector> clone() const {
    return detail::make<detector, sscc_detector>([&](auto out) { return sscc_detector_clone(get(), out); });
  }

  // Returns all colliding pairs at these positions (V x 3), or `limit` of them if there are more, sorted. If none are found and the
  // limit is not 0, the mesh is proven free.
  returns<view<const pair>> discrete(const matrix& x,
                                     std::size_t limit = std::numeric_limits<std::size_t>::max()) {
    const bool is_limited = limit != std::numeric_limits<std::size_t>::max();
    std::size_t count = 0;
    const status s = is_limited ? sscc_detector_discrete_at_most(get(), x, limit, &count)
                                : sscc_detector_discrete(get(), x, &count);
    return discrete_answer(s, count);
  }

  // Returns one colliding pair at these positions (V x 3), or none.
  returns<view<const pair>> first(const matrix& x) {
    std::size_t count = 0;
    const status s = sscc_detector_first(get(), x, nullptr, &count);
    return discrete_answer(s, count);
  }

  // Returns all pairs that collide while every vertex moves on a straight line from x_t0 to x_t1 (V x 3 each), sorted, with their
  // times of impact.
  returns<view<const impact>> continuous(const matrix& x_t0, const matrix& x_t1) {
    std::size_t count = 0;
    const status s = sscc_detector_continuous(get(), x_t0, x_t1, &count);
    return continuous_answer(s, count);
  }

  // Returns all pairs (triangle of this mesh at x, triangle of the other one at y) that collide, sorted. The filters of the
  // detectors have no effect. `other` must be a different detector.
  returns<view<const pair>> against(const matrix& x, detector& other, const matrix& y) {
    std::size_t count = 0;
    const status s = sscc_detector_against(get(), x, other.get(), y, &count);
    return discrete_answer(s, count);
  }

  // Returns all pairs (triangle of this mesh, triangle of the other one) that collide while every vertex of both moves on a
  // straight line, sorted, with their times of impact; otherwise as against().
  returns<view<const impact>> continuous_against(const matrix& x_t0, const matrix& x_t1, detector& other,
                                                 const matrix& y_t0, const matrix& y_t1) {
    std::size_t count = 0;
    const status s = sscc_detector_continuous_against(get(), x_t0, x_t1, other.get(), y_t0, y_t1, &count);
    return continuous_answer(s, count);
  }
};

// A model at some q and pose in the world.
class shape : public detail::answering<detail::shape_api> {
 public:
  shape() = default;
  explicit shape(sscc_shape* handle) noexcept : answering(handle) {}

  static returns<shape> make(const model& m) {
    return detail::make<shape, sscc_shape>([&](auto out) { return sscc_shape_new(m.get(), nullptr, out); });
  }

  static returns<shape> make(const model& m, const certificates& c) {
    return detail::make<shape, sscc_shape>([&](auto out) { return sscc_shape_new(m.get(), c.get(), out); });
  }

  // Returns a copy for another thread. It has no pairs() before its first answer.
  returns<shape> clone() const {
    return detail::make<shape, sscc_shape>([&](auto out) { return sscc_shape_clone(get(), out); });
  }

  // Deforms and moves the shape. Returns a box that contains it.
  returns<box> place(view<const double> q, const pose& at) {
    box bounds{};
    const status s = sscc_shape_place(get(), q.data(), q.size(), &at, &bounds);
    pairs_.clear();
    return detail::finish(s, bounds);
  }

  // Returns all pairs (triangle of this shape, triangle of the other one) that collide, sorted. `bounds` is an AABB that contains
  // all compared shapes; it affects only the time.
  returns<view<const pair>> against(shape& other, const box* bounds = nullptr) {
    std::size_t count = 0;
    const status s = sscc_shape_against(get(), other.get(), bounds, &count);
    return answer(s, count);
  }
};

// Returns the version of the library, such as "0.1.0".
inline const char* version() noexcept { return sscc_version(); }

}  // inline namespace

}  // namespace sscc

#endif
