#include "focus/usual_method.h"

namespace postlens {

UsualMethod usual_method(const SampleHeader& header) {
    if (header.has_layers) return {FocusMethod::layers, "as the file has hidden surfaces"};
    if (header.has_w) return {FocusMethod::layers, "as the file has mirrors or glass"};
    return {FocusMethod::scatter, "as the file has nothing behind what is seen"};
}

UsualMethod usual_method_of_foreign_picture() {
    return {FocusMethod::layers, "as it is a picture of another program"};
}

}  // namespace postlens
