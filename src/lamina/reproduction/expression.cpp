// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/expression.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

using Value = ExpressionValue;

constexpr std::size_t most_elements = 10'000'000;
constexpr int deepest = 100;  // of brackets in brackets

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Reads and evaluates at once, by recursive descent.
class Evaluation {
 public:
  Evaluation(std::string_view text, const ExpressionSources& sources)
      : text_(text), sources_(sources) {}

  Value whole() {
    Value value = disjunction();
    skip_space();
    if (at_ < text_.size()) fail("must end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput("expression \"" + std::string(text_) + "\": " + what + " at character " +
                       std::to_string(at_ + 1));
  }

  void skip_space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }

  bool takes(std::string_view token) {
    skip_space();
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }

  void require(std::string_view token) {
    if (!takes(token)) fail("must have \"" + std::string(token) + "\"");
  }

  template <class F>
  Value each(const Value& a, const Value& b, const F& f) const {
    if (a.size() != b.size() && a.size() != 1 && b.size() != 1)
      fail("lists of " + std::to_string(a.size()) + " and " + std::to_string(b.size()) +
           " elements meet");
    const std::size_t size = a.size() == 1 ? b.size() : a.size();
    Value result(size);
    for (std::size_t i = 0; i < size; ++i)
      result[i] = f(a[a.size() == 1 ? 0 : i], b[b.size() == 1 ? 0 : i]);
    return result;
  }

  Value disjunction() {
    Value left = conjunction();
    while (takes("|"))
      left = each(left, conjunction(),
                  [](double a, double b) { return a != 0.0 || b != 0.0 ? 1.0 : 0.0; });
    return left;
  }

  Value conjunction() {
    Value left = comparison();
    while (takes("&"))
      left = each(left, comparison(),
                  [](double a, double b) { return a != 0.0 && b != 0.0 ? 1.0 : 0.0; });
    return left;
  }

  Value comparison() {
    Value left = sum();
    if (takes("<="))
      return each(left, sum(), [](double a, double b) { return a <= b ? 1.0 : 0.0; });
    if (takes(">="))
      return each(left, sum(), [](double a, double b) { return a >= b ? 1.0 : 0.0; });
    if (takes("=="))
      return each(left, sum(), [](double a, double b) { return a == b ? 1.0 : 0.0; });
    if (takes("<")) return each(left, sum(), [](double a, double b) { return a < b ? 1.0 : 0.0; });
    if (takes(">")) return each(left, sum(), [](double a, double b) { return a > b ? 1.0 : 0.0; });
    return left;
  }

  Value sum() {
    Value left = product();
    for (;;) {
      if (takes("+"))
        left = each(left, product(), [](double a, double b) { return a + b; });
      else if (takes("-"))
        left = each(left, product(), [](double a, double b) { return a - b; });
      else
        return left;
    }
  }

  Value product() {
    Value left = negation();
    for (;;) {
      if (takes("*"))
        left = each(left, negation(), [](double a, double b) { return a * b; });
      else if (takes("/"))
        left = each(left, negation(), [](double a, double b) { return a / b; });
      else
        return left;
    }
  }

  Value negation() {
    if (!takes("-")) return power();
    if (++depth_ > deepest) fail("brackets and signs must not be deeper");
    Value value = negation();
    --depth_;
    for (double& number : value) number = -number;
    return value;
  }

  Value power() {
    Value base = primary();
    if (!takes("^")) return base;
    if (++depth_ > deepest) fail("brackets and signs must not be deeper");
    const Value exponent = negation();
    --depth_;
    return each(base, exponent, [](double a, double b) { return std::pow(a, b); });
  }

  Value primary() {
    if (++depth_ > deepest) fail("brackets and signs must not be deeper");
    Value value = operand();
    --depth_;
    return value;
  }

  Value operand() {
    if (takes("(")) {
      Value value = disjunction();
      require(")");
      return value;
    }
    if (takes("[")) {
      Value list;
      do {
        const Value part = disjunction();
        list.insert(list.end(), part.begin(), part.end());
      } while (takes(","));
      require("]");
      return list;
    }
    skip_space();
    if (at_ == text_.size()) fail("must go on");
    const char c = text_[at_];
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') return {number()};
    if (!is_name_character(c)) fail("must have a number, a name or a bracket");
    const std::size_t start = at_;
    while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
    const std::size_t end_of_name = at_;
    const std::string name(text_.substr(start, at_ - start));
    if (takes("(")) return function(name);
    at_ = end_of_name;  // before the space that was skipped
    // The path: .key, [index], [:]
    for (;;) {
      if (at_ < text_.size() && text_[at_] == '.') {
        ++at_;
        while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
      } else if (at_ < text_.size() && text_[at_] == '[') {
        const std::size_t end = text_.find(']', at_);
        if (end == std::string_view::npos) fail("must have \"]\"");
        at_ = end + 1;
      } else {
        break;
      }
    }
    return sources_.value(text_.substr(start, at_ - start));
  }

  double number() {
    std::size_t end = at_;
    while (end < text_.size() &&
           (is_name_character(text_[end]) || text_[end] == '.' ||
            ((text_[end] == '-' || text_[end] == '+') && (text_[end - 1] == 'e'))))
      ++end;
    double value = 0.0;
    const char* const last = text_.data() + end;
    const auto [stopped, error] = std::from_chars(text_.data() + at_, last, value);
    if (error != std::errc() || stopped != last) fail("must have a number");
    at_ = end;
    return value;
  }

  std::string quoted() {
    require("'");
    const std::size_t end = text_.find('\'', at_);
    if (end == std::string_view::npos) fail("must have a closing quote");
    const std::string text(text_.substr(at_, end - at_));
    at_ = end + 1;
    return text;
  }

  double one(const Value& value) const {
    if (value.size() != 1) fail("must have one number and not " + std::to_string(value.size()));
    return value[0];
  }

  Value function(const std::string& name) {
    if (name == "pixels") {
      const std::string file = quoted();
      require(",");
      const std::string channel = quoted();
      std::array<double, 4> part{};
      for (double& edge : part) {
        require(",");
        edge = one(disjunction());
      }
      require(")");
      return sources_.pixels(file, channel, part[0], part[1], part[2], part[3]);
    }
    if (name == "runs") {
      const std::string prefix = quoted();
      require(",");
      const std::string path = quoted();
      require(")");
      return sources_.runs(prefix, path);
    }
    std::vector<Value> arguments;
    do arguments.push_back(disjunction());
    while (takes(","));
    require(")");
    return call(name, arguments);
  }

  Value call(const std::string& name, const std::vector<Value>& a) const {
    const auto takes_arguments = [&](std::size_t count) {
      if (a.size() != count)
        fail(name + " must have " + std::to_string(count) + " arguments, but has " +
             std::to_string(a.size()));
    };
    using Function = double (*)(double);
    static constexpr std::array<std::pair<std::string_view, Function>, 7> functions = {
        {{"abs", [](double x) { return std::abs(x); }},
         {"sqrt", [](double x) { return std::sqrt(x); }},
         {"exp", [](double x) { return std::exp(x); }},
         {"log", [](double x) { return std::log(x); }},
         {"log10", [](double x) { return std::log10(x); }},
         {"sin", [](double x) { return std::sin(x); }},
         {"cos", [](double x) { return std::cos(x); }}}};
    for (const auto& [known, f] : functions)
      if (name == known) {
        takes_arguments(1);
        Value result = a[0];
        for (double& x : result) x = f(x);
        return result;
      }
    const bool is_min = name == "min", is_max = name == "max";
    if ((is_min || is_max) && a.size() == 2)
      return each(a[0], a[1],
                  [&](double x, double y) { return is_min ? std::min(x, y) : std::max(x, y); });
    if (const std::optional<double> reduced = reduce(name, a[0])) {
      takes_arguments(1);
      return {*reduced};
    }
    if (name == "if") {
      takes_arguments(3);
      const Value chosen = each(a[0], a[1], [](double c, double x) { return c != 0.0 ? x : 0.0; });
      const Value other = each(a[0], a[2], [](double c, double x) { return c != 0.0 ? 0.0 : x; });
      return each(chosen, other, [](double x, double y) { return x + y; });
    }
    if (name == "range") {
      takes_arguments(3);
      const double first = one(a[0]), last = one(a[1]), count = one(a[2]);
      if (!(count >= 1.0 && count <= most_elements)) fail("range: a count must be 1 or more");
      Value result(static_cast<std::size_t>(count), first);
      for (std::size_t i = 1; i < result.size(); ++i)
        result[i] = first + (last - first) * static_cast<double>(i) / (count - 1.0);
      return result;
    }
    if (name == "reverse") {
      takes_arguments(1);
      return {a[0].rbegin(), a[0].rend()};
    }
    if (name == "slice") {
      takes_arguments(3);
      const auto size = static_cast<double>(a[0].size());
      const auto place = [&](double i) { return std::clamp(i < 0.0 ? size + i : i, 0.0, size); };
      const double first = place(one(a[1])), last = std::max(first, place(one(a[2])));
      return {a[0].begin() + static_cast<std::ptrdiff_t>(first),
              a[0].begin() + static_cast<std::ptrdiff_t>(last)};
    }
    if (name == "at" || name == "integral" || name == "peak") {
      takes_arguments(name == "at" ? 3 : 2);
      if (a[0].size() != a[1].size() || a[0].empty()) fail(name + ": x and y must go together");
      if (name == "integral") return {integral(a[0], a[1])};
      if (name == "peak")
        return {a[0][static_cast<std::size_t>(std::ranges::max_element(a[1]) - a[1].begin())]};
      Value result = a[2];
      for (double& x : result) x = interpolated(a[0], a[1], x);
      return result;
    }
    fail("there is no function " + name);
  }

  std::optional<double> reduce(const std::string& name, const Value& a) const {
    const bool is_known = name == "min" || name == "max" || name == "mean" || name == "sum" ||
                          name == "rms" || name == "count" || name == "first" || name == "last" ||
                          name == "all" || name == "any";
    if (!is_known) return std::nullopt;
    const auto count = static_cast<double>(a.size());
    if (name == "count") return count;
    if (a.empty()) fail(name + " must have a list with elements");
    if (name == "min") return std::ranges::min(a);
    if (name == "max") return std::ranges::max(a);
    if (name == "first") return a.front();
    if (name == "last") return a.back();
    if (name == "all") return std::ranges::count(a, 0.0) == 0 ? 1.0 : 0.0;
    if (name == "any") return std::ranges::any_of(a, [](double x) { return x != 0.0; }) ? 1.0 : 0.0;
    if (name == "rms")
      return std::sqrt(std::inner_product(a.begin(), a.end(), a.begin(), 0.0) / count);
    const double sum = std::accumulate(a.begin(), a.end(), 0.0);
    return name == "sum" ? sum : sum / count;
  }

  static double integral(const Value& x, const Value& y) {
    double sum = 0.0;
    for (std::size_t i = 1; i < x.size(); ++i) sum += 0.5 * (x[i] - x[i - 1]) * (y[i] + y[i - 1]);
    return sum;
  }

  double interpolated(const Value& x, const Value& y, double at) const {
    if (!std::ranges::is_sorted(x)) fail("at: x must ascend");
    const auto above = static_cast<std::size_t>(std::ranges::upper_bound(x, at) - x.begin());
    if (above == 0) return y.front();
    if (above == x.size()) return y.back();
    const double share = (at - x[above - 1]) / (x[above] - x[above - 1]);
    return y[above - 1] + share * (y[above] - y[above - 1]);
  }

  std::string_view text_;
  const ExpressionSources& sources_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

ExpressionValue evaluate_expression(std::string_view text, const ExpressionSources& sources) {
  return Evaluation(text, sources).whole();
}

double evaluate_number(std::string_view text, const ExpressionSources& sources) {
  const ExpressionValue value = evaluate_expression(text, sources);
  if (value.size() != 1)
    throw InvalidInput("expression \"" + std::string(text) + "\": must be one number, but is " +
                       std::to_string(value.size()));
  return value[0];
}

}  // namespace lamina
