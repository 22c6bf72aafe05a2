// Which lines an outline is made of: chains of the network's segments, as many as fit into its
// file.
#pragma once

#include "outline/network.h"
#include "outline/outline_builder.h"
#include "outline/polyline.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace meshhier::outline {

/// All chains with the significance of their points, to be cut to any tolerance: first those of
/// borders and sectors, then those that draw the form.
class Lines {
 public:
  /// `least`: the smallest tolerance that will be asked for, `shortest`: lines of the form that are
  /// shorter are left out; both in input units. Takes the network's segments; its positions must
  /// outlive this. O(s log s) for s segments.
  Lines(Network& network, double least, double shortest);

  std::size_t size() const { return chains_.size(); }
  bool is_form(std::size_t chain) const { return chain >= form_begin_; }

  /// Vertices of a chain that are left with a tolerance in input units.
  std::size_t vertex_count(std::size_t chain, double tolerance);

  void append_to(Outline& outline, std::size_t chain, double tolerance);

  /// Before simplification, input units.
  double length(std::size_t chain) const { return lengths_[chain]; }

  /// Chains by length, the longest first, equal ones in order.
  std::vector<std::uint32_t> by_length() const;

 private:
  std::vector<Vec3f> points_of(std::span<const std::uint32_t> nodes) const;
  const std::vector<double>& significance_of(std::size_t chain);
  void add_forms(const Chains& forms, double shortest);

  std::span<const Vec3f> positions_;
  Chains chains_;
  std::size_t form_begin_;
  double least_;
  std::vector<double> lengths_;  ///< of the chains
  /// Of a chain's nodes. Few of the many lines of a soup are ever asked for.
  std::map<std::size_t, std::vector<double>> significance_;
};

/// Which chains an outline is made of, with which tolerance.
struct Selection {
  std::vector<std::uint32_t> chains;  ///< ascending
  double tolerance = 0;               ///< of those that are no form, a part of the diagonal
};

/// Lines of the form come first, with options.tolerance, the longest first, in at most half of the
/// file. Of the others the finest tolerance with which all but specks fit; then whatever fits, the
/// longest first.
Selection select(Lines& lines, const OutlineOptions& options);

}  // namespace meshhier::outline
