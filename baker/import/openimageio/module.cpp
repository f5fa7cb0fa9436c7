#include "baker/import/openimageio/module.hpp"

extern "C" __attribute__((visibility("default"))) const lambent::baker::OpenImageIo lambent_openimageio;

const lambent::baker::OpenImageIo lambent_openimageio = {
    .decode = lambent::baker::openimageio::decode,
    .encodeJpeg = lambent::baker::openimageio::encodeJpeg,
    .encodePng = lambent::baker::openimageio::encodePng,
    .readVdb = lambent::baker::openimageio::readVdb};
