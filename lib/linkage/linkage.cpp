#include "lib/linkage/linkage.hpp"

namespace hb {

const Body* body_at(const Linkage& linkage, int index) {
  if (index == 0) return &linkage.crank.body;
  const Dyad& dyad = linkage.dyads[static_cast<std::size_t>((index - 1) / 2)];
  if (index % 2 == 1) return &dyad.coupler;
  const auto* rocker = std::get_if<Rocker>(&dyad.closing);
  return rocker ? &rocker->body : nullptr;
}

const std::string& body_name(const Linkage& linkage, int index) {
  if (const Body* body = body_at(linkage, index)) return body->name;
  return std::get<Slider>(linkage.dyads[static_cast<std::size_t>((index - 1) / 2)].closing).name;
}

std::vector<int> elastic_links(const Linkage& linkage) {
  std::vector<int> links;
  for (int index = 1; index < linkage.num_bodies(); ++index) {
    const Body* body = body_at(linkage, index);
    if (body && body->elastic) links.push_back(index);
  }
  return links;
}

}  // namespace hb
