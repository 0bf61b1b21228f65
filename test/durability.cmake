# What happens to maps when nodes are killed and disks are full: the real nodes, started by the tests.
add_library(full_disk_preload MODULE EXCLUDE_FROM_ALL ros/durability/full_disk_preload.cpp)
target_link_libraries(full_disk_preload ${CMAKE_DL_LIBS})
add_dependencies(tests full_disk_preload)
set(durability_nodes map_manager_node map_tool perennial_strategies repeat_navigator_node teach_recorder_node)
add_rostest(ros/durability/kill.test ARGS folder:=${scratch}/kill DEPENDENCIES ${durability_nodes})
add_rostest(ros/durability/durability.test
  ARGS folder:=${scratch}/durability
  DEPENDENCIES ${durability_nodes} full_disk_preload)
