// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/cell_graph.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>

namespace lamina {
namespace {

/// Fraction of the cells that are no smaller than what counts as typical. Steps in time are as long
/// as cells of the typical area bear; smaller ones would need shorter ones.
constexpr double share_of_large_cells = 0.8;

/// Largest sum of a cell's rates: that of squares in a lattice.
constexpr float largest_rate = 2.0f;

float typical(std::vector<float> areas) {
  const auto place = static_cast<std::ptrdiff_t>((1.0 - share_of_large_cells) *
                                                 static_cast<double>(areas.size() - 1));
  std::nth_element(areas.begin(), areas.begin() + place, areas.end());
  return areas[static_cast<std::size_t>(place)];
}

/// The neighbours of all cells, both ways, and their rates.
CellLevel make_level(std::span<const GraphCell> cells, std::span<const CellLink> links) {
  CellLevel level;
  for (const GraphCell& cell : cells) level.area.push_back(cell.area);
  level.typical_area = typical(level.area);
  std::vector<float> total(cells.size(), 0.0f);
  level.first.assign(cells.size() + 1, 0);
  for (const CellLink& link : links)
    for (const std::uint32_t end : {link.from, link.to}) {
      total[end] += 0.5f * level.typical_area * link.conductance / level.area[end];
      ++level.first[end + 1];
    }
  std::partial_sum(level.first.begin(), level.first.end(), level.first.begin());
  level.neighbors.resize(level.first.back());
  level.rate.assign(cells.size(), 0.0f);
  std::vector<std::uint32_t> next(level.first.begin(), level.first.end() - 1);
  for (const CellLink& link : links) {
    // One factor for both ends, so that no light is lost.
    const float slowed = link.conductance /
                         std::max(1.0f, std::max(total[link.from], total[link.to]) / largest_rate);
    const auto add = [&](std::uint32_t from, std::uint32_t to) {
      const float rate = 0.5f * level.typical_area * slowed / level.area[from];
      level.neighbors[next[from]++] = {to, rate};
      level.rate[from] += rate;
    };
    add(link.from, link.to);
    add(link.to, link.from);
  }
  return level;
}

/// Numbers for the squares of two by two cells, [cell]; their count.
std::uint32_t pair_cells(std::span<const GraphCell> cells, std::vector<std::uint32_t>& parent) {
  std::vector<std::uint32_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const GraphCell& cell = cells[i];
    return std::tuple(cell.chart, cell.y >> 1, cell.x >> 1);
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key(a), a) < std::tuple(key(b), b);
  });
  parent.resize(cells.size());
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++count;
    parent[order[i]] = count;
  }
  return count + 1;
}

struct Coarser {
  std::vector<GraphCell> cells;
  std::vector<CellLink> links;
};

/// Parents from their children.
std::vector<GraphCell> make_parents(std::span<const GraphCell> cells,
                                    std::span<const std::uint32_t> parent, std::uint32_t count) {
  std::vector<GraphCell> parents(count);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    GraphCell& to = parents[parent[i]];
    if (to.area == 0.0f) {
      to.chart = cells[i].chart;
      to.x = cells[i].x >> 1;
      to.y = cells[i].y >> 1;
    }
    to.area += cells[i].area;
    to.position += cells[i].area * cells[i].position;
  }
  for (GraphCell& to : parents)
    if (to.area > 0.0f) to.position = to.position / to.area;
  return parents;
}

/// Links between parents, several children's put together, sorted.
std::vector<CellLink> link_parents(std::span<const GraphCell> cells,
                                   std::span<const CellLink> links,
                                   std::span<const std::uint32_t> parent,
                                   std::span<const GraphCell> parents) {
  std::vector<CellLink> all;
  for (const CellLink& link : links) {
    std::uint32_t a = parent[link.from], b = parent[link.to];
    if (a == b) continue;
    const Vec3f between = cells[link.to].position - cells[link.from].position;
    const Vec3f apart = parents[b].position - parents[a].position;
    const float share = dot(between, apart) / std::max(dot(apart, apart), 1e-12f);
    if (!(share > 0.0f)) continue;
    if (a > b) std::swap(a, b);
    all.push_back({a, b, link.conductance * std::min(share, 2.0f)});
  }
  std::ranges::sort(all, [](const CellLink& a, const CellLink& b) {
    return std::tuple(a.from, a.to, a.conductance) < std::tuple(b.from, b.to, b.conductance);
  });
  std::vector<CellLink> joined;
  for (const CellLink& link : all)
    if (!joined.empty() && joined.back().from == link.from && joined.back().to == link.to)
      joined.back().conductance += link.conductance;
    else
      joined.push_back(link);
  return joined;
}

/// Gives the children of parents that are but slivers to the neighbour that these are tied to best.
/// @return  the number of parents left
std::uint32_t join_slivers(std::span<const GraphCell> cells, std::span<const CellLink> links,
                           std::vector<std::uint32_t>& parent, std::uint32_t count) {
  const std::vector<GraphCell> parents = make_parents(cells, parent, count);
  std::vector<float> areas;
  for (const GraphCell& cell : parents) areas.push_back(cell.area);
  const float least = 0.4f * typical(areas);
  std::vector<float> tie(count, 0.0f);
  std::vector<std::uint32_t> to(count);
  std::iota(to.begin(), to.end(), 0u);
  for (const CellLink& link : link_parents(cells, links, parent, parents))
    for (const auto& [a, b] : {std::pair(link.from, link.to), std::pair(link.to, link.from)})
      if (areas[a] < least && areas[b] >= least && link.conductance > tie[a]) {
        tie[a] = link.conductance;
        to[a] = b;
      }
  std::vector<std::uint32_t> number(count, 0);
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < count; ++i)
    if (to[i] == i) number[i] = left++;
  for (std::uint32_t& each : parent) each = number[to[each]];
  return left;
}

void list_children(CellLevel& level, std::size_t parents) {
  level.first_child.assign(parents + 1, 0);
  for (const std::uint32_t p : level.parent) ++level.first_child[p + 1];
  std::partial_sum(level.first_child.begin(), level.first_child.end(), level.first_child.begin());
  level.children.resize(level.parent.size());
  std::vector<std::uint32_t> next(level.first_child.begin(), level.first_child.end() - 1);
  for (std::uint32_t i = 0; i < level.parent.size(); ++i)
    level.children[next[level.parent[i]]++] = i;
}

}  // namespace

CellGraph make_cell_graph(std::span<const GraphCell> cells, std::span<const CellLink> links,
                          double largest_area) {
  assert(!cells.empty());
  constexpr std::size_t fewest = 16;  // cells
  CellGraph graph;
  graph.levels.push_back(make_level(cells, links));
  Coarser fine{{cells.begin(), cells.end()}, {links.begin(), links.end()}};
  while (static_cast<double>(graph.levels.back().typical_area) < largest_area &&
         fine.cells.size() > fewest) {
    CellLevel& level = graph.levels.back();
    std::uint32_t count = pair_cells(fine.cells, level.parent);
    count = join_slivers(fine.cells, fine.links, level.parent, count);
    if (count == fine.cells.size()) {
      level.parent.clear();
      break;
    }
    list_children(level, count);
    Coarser next;
    next.cells = make_parents(fine.cells, level.parent, count);
    next.links = link_parents(fine.cells, fine.links, level.parent, next.cells);
    fine = std::move(next);
    graph.levels.push_back(make_level(fine.cells, fine.links));
  }
  return graph;
}

}  // namespace lamina
