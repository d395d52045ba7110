#include "app/host/required_modules.h"

#include "app/host/rank_scope.h"
#include "shading/camera/image_file.h"

namespace carousel::app {

void require_modules(const EngineConfig& engine, const WorkloadConfig& workload, const ImageConfig& image) {
  if (engine.transport == EngineTransport::kMpi) require_mpi_module();
  if (workload.kind == WorkloadConfig::Kind::kRays) shading::require_picture_files(image.files);
}

}  // namespace carousel::app
