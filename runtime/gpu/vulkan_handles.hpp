#pragma once

// Forward declarations of the Vulkan handles that the public headers of runtime/gpu hold, so that no other
// folder includes volk.h. 64-bit platforms only, where every handle is a pointer.
static_assert(sizeof(void*) == 8);

struct VkBuffer_T;
struct VkBufferView_T;
struct VkDeviceMemory_T;
struct VkImage_T;
struct VkImageView_T;
struct VkSampler_T;
struct VkShaderModule_T;
struct VkDescriptorSetLayout_T;
struct VkPipelineLayout_T;
struct VkPipeline_T;
struct VkCommandPool_T;
struct VkCommandBuffer_T;
struct VkQueryPool_T;
struct VkFence_T;
