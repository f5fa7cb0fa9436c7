#include "baker/sweep/rows.hpp"

#include <nlohmann/json.hpp>

namespace lambent::baker {

using nlohmann::json;

static json timesJson(const NamedTimes& times) {
  json list = json::array();
  for (const auto& [name, time] : times) list.push_back({{"name", name}, {"time", time}});
  return list;
}

static NamedTimes timesFrom(const json& list) {
  NamedTimes times;
  for (const json& one : list)
    times.emplace_back(one.at("name").get<std::string>(), one.at("time").get<double>());
  return times;
}

static void to_json(json& out, const Figures& f) {
  out = {{"rms", f.rms}, {"rmsSpread", f.rms_spread}, {"percentile99", f.percentile_99}, {"bias", f.bias}};
}

static void from_json(const json& in, Figures& f) {
  in.at("rms").get_to(f.rms);
  in.at("rmsSpread").get_to(f.rms_spread);
  in.at("percentile99").get_to(f.percentile_99);
  in.at("bias").get_to(f.bias);
}

double PictureRow::costMs() const {
  const bool on_processor =
      renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
  return on_processor ? processor_ms : frame_ms;
}

void to_json(json& out, const MemoryRow& row) {
  out = {{"least", row.least}, {"most", row.most}};
}

void from_json(const json& in, MemoryRow& row) {
  in.at("least").get_to(row.least);
  in.at("most").get_to(row.most);
}

void to_json(json& out, const ReferenceRow& row) {
  out = {{"seconds", row.seconds}, {"noise", row.noise}};
}

void from_json(const json& in, ReferenceRow& row) {
  in.at("seconds").get_to(row.seconds);
  in.at("noise").get_to(row.noise);
}

void to_json(json& out, const BakeRow& row) {
  out = {{"seconds", row.seconds},
         {"leastSeconds", row.least_seconds},
         {"mostSeconds", row.most_seconds},
         {"runs", row.runs},
         {"processorSeconds", row.processor_seconds},
         {"stages", timesJson(row.stages)},
         {"bytes", row.bytes},
         {"transferBytes", row.transfer_bytes},
         {"vertices", row.vertices},
         {"samples", row.samples},
         {"parts", nullptr}};
  if (row.parts)
    out["parts"] = {{"noise", row.parts->noise},
                    {"codes", row.parts->codes},
                    {"interpolation", row.parts->interpolation}};
}

void from_json(const json& in, BakeRow& row) {
  in.at("seconds").get_to(row.seconds);
  in.at("leastSeconds").get_to(row.least_seconds);
  in.at("mostSeconds").get_to(row.most_seconds);
  in.at("runs").get_to(row.runs);
  in.at("processorSeconds").get_to(row.processor_seconds);
  row.stages = timesFrom(in.at("stages"));
  in.at("bytes").get_to(row.bytes);
  in.at("transferBytes").get_to(row.transfer_bytes);
  in.at("vertices").get_to(row.vertices);
  in.at("samples").get_to(row.samples);
  if (const json& parts = in.at("parts"); !parts.is_null())
    row.parts = BakeRow::Parts{parts.at("noise").get<double>(), parts.at("codes").get<double>(),
                               parts.at("interpolation").get<double>()};
}

void to_json(json& out, const PictureRow& row) {
  out = {{"frameMs", row.frame_ms},     {"slowestMs", row.slowest_ms},     {"processorMs", row.processor_ms},
         {"frames", row.frames},        {"passes", timesJson(row.passes)}, {"gpuBytes", row.gpu_bytes},
         {"keyLights", row.key_lights}, {"renderer", row.renderer}};
  to_json(out["asLightIs"], row.as_light_is);
  to_json(out["asBandsCan"], row.as_bands_can);
}

void from_json(const json& in, PictureRow& row) {
  in.at("frameMs").get_to(row.frame_ms);
  in.at("slowestMs").get_to(row.slowest_ms);
  in.at("processorMs").get_to(row.processor_ms);
  in.at("frames").get_to(row.frames);
  row.passes = timesFrom(in.at("passes"));
  in.at("gpuBytes").get_to(row.gpu_bytes);
  in.at("keyLights").get_to(row.key_lights);
  in.at("renderer").get_to(row.renderer);
  from_json(in.at("asLightIs"), row.as_light_is);
  from_json(in.at("asBandsCan"), row.as_bands_can);
}

}  // namespace lambent::baker
